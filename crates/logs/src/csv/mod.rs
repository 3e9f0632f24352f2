//! Tables: CSV files and tables in memory, their headers, columns, cells and rows.

mod blanks;
mod cell;
mod csv_file;
mod cut_end;
pub(crate) mod header;
pub(crate) mod lines;
pub(crate) mod lookup;
pub(crate) mod memory_table;
pub(crate) mod output;
pub(crate) mod table;
pub(crate) mod table_file;
mod table_head;
pub(crate) mod table_source;
pub(crate) mod times;
pub(crate) mod written;
