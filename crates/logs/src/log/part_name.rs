//! Names of files that belong to a log.

use std::path::Path;

use super::file_names::{
    ANTENNA, CONTACTS, NAMES, NODES, PACKETS, PATH, RANGES, RECEPTIONS, SECTOR_SNRS, SECTORS, STOPS,
};
use super::layout::FolderLog;
use crate::bag;

/// The files of a folder whose names say what they are.
const PARTS: [&str; 12] = [
    STOPS,
    RECEPTIONS,
    RANGES,
    CONTACTS,
    SECTORS,
    ANTENNA,
    SECTOR_SNRS,
    PACKETS,
    PATH,
    NODES,
    NAMES,
    "metadata.yaml",
];

/// Whether a new file at `path` would be read as a part of the log in its folder, or keep that from being read. `read` is a log
/// that is read now, if there is one. Capital letters are small ones here, as on some file systems.
#[must_use]
pub fn is_part_of_log(path: &Path, read: Option<&Path>) -> bool {
    let Some(name) = path.file_name().map(|name| name.to_string_lossy().to_lowercase()) else { return false };
    let above = path.parent().filter(|above| !above.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(folder) = above.canonicalize() else { return false };
    let is_read = read.and_then(|read| read.canonicalize().ok()).is_some_and(|read| read == folder);
    let found = FolderLog::of(&folder);
    match Path::new(&name).extension().and_then(|extension| extension.to_str()) {
        _ if PARTS.contains(&name.as_str()) => is_read || found == FolderLog::Named,
        Some("gpx" | "nmea" | "tum" | "pcap" | "pcapng" | "cap" | "db3" | "bag" | "zstd") => {
            is_read || found == FolderLog::Named
        }
        // In a folder without other parts, each table could be the log.
        Some("csv" | "tsv") => is_read && found == FolderLog::None,
        Some("mcap") => bag::holds_bag(&folder),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_kit::folder_of;

    /// A folder with files of these names.
    fn folder(names: &[&str]) -> tempfile::TempDir {
        folder_of(names.iter().map(|name| (*name, "a,b\n")))
    }

    /// Those of `names` that may not be written, if the folder is read, and if another log is.
    fn refused(files: &[&str], names: &[&str]) -> [Vec<String>; 2] {
        let folder = folder(files);
        [Some(folder.path()), None].map(|read| {
            let is_refused = |name: &&&str| is_part_of_log(&folder.path().join(name), read);
            names.iter().filter(is_refused).map(|name| (*name).to_owned()).collect()
        })
    }

    #[test]
    fn a_log_of_stops_takes_the_names_that_the_reader_knows() {
        let parts = [
            "stops.csv",
            "receptions.csv",
            "contacts.csv",
            "sectors.csv",
            "antenna.toml",
            "sector_snrs.csv",
            "packets.csv",
            "path.csv",
            "nodes.csv",
            "names.csv",
            "Contacts.CSV",
            "walk.gpx",
            "walk.nmea",
            "walk.tum",
            "a.pcap",
            "a.PCAPNG",
            "a.db3",
            "metadata.yaml",
        ];
        for files in [&["stops.csv", "receptions.csv"][..], &["path.csv", "packets.csv"]] {
            assert_eq!(
                refused(files, &parts),
                [parts.map(str::to_owned).to_vec(), parts.map(str::to_owned).to_vec()]
            );
            let others = ["map.csv", "map.geojson", "report.html", "summary.json", "ranges-map.csv", "run.mcap"];
            assert_eq!(refused(files, &others), [Vec::<String>::new(), Vec::new()]);
        }
    }

    #[test]
    fn a_table_alone_in_its_folder_gets_no_second_one() {
        let names = ["map.csv", "map.tsv", "map.geojson", "contacts.csv"];
        let [read, other] = refused(&["rssi.csv"], &names);
        assert_eq!(read, ["map.csv", "map.tsv", "contacts.csv"]);
        assert_eq!(other, [""; 0], "a folder with a table may be any folder");
        assert_eq!(refused(&[], &["contacts.csv"])[1], [""; 0]);
    }

    #[test]
    fn a_folder_with_captures_may_get_others() {
        let folder = folder(&[]);
        std::fs::write(folder.path().join("a.pcap"), [0xd4, 0xc3, 0xb2, 0xa1, 2, 0, 4, 0]).unwrap();
        for name in ["a.pcap", "b.pcap", "map.csv"] {
            assert!(!is_part_of_log(&folder.path().join(name), None), "{name}");
        }
        assert!(is_part_of_log(&folder.path().join("b.pcap"), Some(folder.path())));
    }

    #[test]
    fn each_name_of_a_folder_is_that_folder() {
        let log = folder(&["stops.csv", "receptions.csv"]);
        std::fs::create_dir(log.path().join("below")).unwrap();
        assert!(is_part_of_log(&log.path().join("below/../contacts.csv"), None));
        assert!(!is_part_of_log(&log.path().join("below/contacts.csv"), None));
        #[cfg(unix)]
        {
            let other = folder(&[]);
            std::os::unix::fs::symlink(log.path(), other.path().join("link")).unwrap();
            assert!(is_part_of_log(&other.path().join("link/contacts.csv"), None));
        }
        assert!(!is_part_of_log(Path::new("/no/such/folder/contacts.csv"), None));
    }
}
