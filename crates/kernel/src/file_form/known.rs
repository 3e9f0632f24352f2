//! Forms of files by the octets with which they begin.

use super::FileForm;

/// Octets at a place of a file, and what it is.
struct Mark {
    at: usize,
    octets: &'static [u8],
    form: FileForm,
}

const fn mark(at: usize, octets: &'static [u8], what: &'static str, helps: &'static str) -> Mark {
    Mark { at, octets, form: FileForm { what, helps } }
}

/// What Wireshark's `editcap` makes a plain capture of.
const EDITCAP: &str = "make a plain capture of it: `editcap -F pcap FILE NEW.pcap` (of Wireshark)";
const PICTURE: &str = "give the file with the numbers of which it was drawn";
const SPREADSHEET: &str = "save each sheet as CSV (UTF-8)";
const DATA_FRAME: &str =
    "write it as CSV, in Python: `pandas.read_parquet(\"FILE\").to_csv(\"NEW.csv\", index=False)`";
const UTF_16: &str = "save it as UTF-8: `iconv -f UTF-16 -t UTF-8 FILE > NEW.csv`";

/// The marks, of which the first one that fits counts.
const MARKS: &[Mark] = &[
    mark(0, b"\x1f\x8b", "compressed with gzip", "unpack it: `gunzip -k FILE` (an archive: `tar xf FILE`)"),
    mark(0, b"\xfd7zXZ\0", "compressed with xz", "unpack it: `unxz -k FILE` (an archive: `tar xf FILE`)"),
    mark(0, b"\x28\xb5\x2f\xfd", "compressed with zstd", "unpack it: `unzstd FILE` (an archive: `tar xf FILE`)"),
    mark(0, b"BZh", "compressed with bzip2", "unpack it: `bunzip2 -k FILE` (an archive: `tar xf FILE`)"),
    mark(0, b"\x04\x22\x4d\x18", "compressed with lz4", "unpack it: `unlz4 FILE`"),
    mark(0, b"\x1f\x9d", "compressed with compress", "unpack it: `gunzip -k FILE`"),
    mark(0, b"7z\xbc\xaf\x27\x1c", "an archive of 7-Zip", "unpack it: `7z x FILE`"),
    mark(0, b"Rar!\x1a\x07", "an archive of RAR", "unpack it: `unrar x FILE`"),
    mark(257, b"ustar", "an archive of tar", "unpack it: `tar xf FILE`"),
    mark(0, b"\xff\xfe\0\0", "text in UTF-32", "save it as UTF-8: `iconv -f UTF-32 -t UTF-8 FILE > NEW.csv`"),
    mark(0, b"\xff\xfe", "text in UTF-16", UTF_16),
    mark(0, b"\xfe\xff", "text in UTF-16", UTF_16),
    // A pcap file with further fields in the header of each packet, in both byte orders.
    mark(0, b"\x34\xcd\xb2\xa1", "a modified pcap capture (magic number a1b2cd34)", EDITCAP),
    mark(0, b"\xa1\xb2\xcd\x34", "a modified pcap capture (magic number a1b2cd34)", EDITCAP),
    mark(0, b"snoop\0\0\0", "a capture of snoop", EDITCAP),
    mark(
        0,
        b"btsnoop\0",
        "a capture of Bluetooth (btsnoop), which has no frames of IEEE 802.15.4 or 802.11",
        "give a capture of the nodes",
    ),
    mark(0, b"GMBU", "a capture of Microsoft Network Monitor", EDITCAP),
    mark(0, b"\x7fver", "a capture of OmniPeek", EDITCAP),
    mark(0, b"#Format=4", "a capture of a Daintree SNA, as KillerBee writes it (.dcf, .dump)", EDITCAP),
    mark(
        0,
        b"version https://git-lfs.github.com/",
        "a pointer of Git LFS, not the file itself",
        "fetch the file: `git lfs pull` in its repository",
    ),
    mark(
        0,
        b"/annex/objects/",
        "a pointer of git-annex, not the file itself",
        "fetch the file: `git annex get FILE`",
    ),
    mark(
        0,
        b"#ROSBAG V",
        "a bag of ROS 1",
        "convert it: `rosbags-convert --src FILE --dst NEW_FOLDER --dst-storage mcap` (Python package rosbags)",
    ),
    mark(
        0,
        b"rosbag2_bagfile_information:",
        "the metadata of a ROS 2 bag",
        "give the folder of the bag, which has the messages",
    ),
    mark(
        0,
        b"SQLite format 3\0",
        "a database of SQLite",
        "of a ROS 2 bag, give the folder that has its metadata.yaml",
    ),
    mark(0, b"ULog\x01\x12\x35", "a flight log of PX4 (ULog)", "make CSV files of it: `ulog2csv FILE` (pyulog)"),
    mark(0, b"\xa3\x95\x80", "a flight log of ArduPilot", "make CSV files of it: `mavlogdump.py --format csv FILE`"),
    mark(
        8,
        b".FIT",
        "a track of a sports watch (FIT)",
        "make GPX of it: `gpsbabel -i garmin_fit -f FILE -o gpx -F NEW.gpx`",
    ),
    mark(0, b"PAR1", "a Parquet table", DATA_FRAME),
    mark(
        0,
        b"ARROW1",
        "an Arrow table",
        "write it as CSV, in Python: `pandas.read_feather(\"FILE\").to_csv(\"NEW.csv\")`",
    ),
    mark(0, b"\x89HDF\r\n\x1a\n", "an HDF5 file (so are MATLAB files of version 7.3)", "write its arrays as CSV"),
    mark(0, b"MATLAB ", "a MATLAB file", "write its variables as CSV: `writetable`, or scipy.io.loadmat in Python"),
    mark(0, b"\x93NUMPY", "an array of NumPy", "write it as CSV: `numpy.savetxt`"),
    mark(
        0,
        b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1",
        "a file of an old Office program (an Excel table .xls, say)",
        SPREADSHEET,
    ),
    mark(0, b"%PDF", "a PDF document", "give the table as CSV; a printed one is not read"),
    mark(0, b"{\\rtf", "a text of a word processor (RTF)", "save it as plain text in UTF-8"),
    mark(0, b"\x89PNG\r\n\x1a\n", "a picture (PNG)", PICTURE),
    mark(0, b"\xff\xd8\xff", "a picture (JPEG)", PICTURE),
    mark(0, b"GIF8", "a picture (GIF)", PICTURE),
    mark(0, b"II*\0", "a picture (TIFF)", PICTURE),
    mark(0, b"MM\0*", "a picture (TIFF)", PICTURE),
    mark(0, b"BM", "a picture (BMP)", PICTURE),
    mark(8, b"WEBP", "a picture (WebP)", PICTURE),
    mark(8, b"WAVE", "a sound (WAV)", "give what was received, not a recording of it as sound"),
    mark(4, b"ftyp", "a film (MP4)", "give a log, not a film"),
    mark(0, b"\x7fELF", "a program", "give the file that it writes"),
    mark(0, b"MZ\x90\0", "a program", "give the file that it writes"),
    mark(
        0,
        b"// CST Farfield Source File",
        "a far field of CST (.ffs), which has field strengths",
        "export the gain as text",
    ),
    mark(0, b"<<<<<<< ", "a text with conflicts of a merge", "settle the conflicts first"),
    mark(0, b"-----BEGIN ", "a key, a certificate or an encrypted message", "give the file itself"),
];

/// What the octets say.
pub(super) fn of(head: &[u8]) -> Option<FileForm> {
    if head.is_empty() {
        return Some(FileForm { what: "empty", helps: "record or copy it again" });
    }
    if head.starts_with(b"PK\x03\x04") || head.starts_with(b"PK\x05\x06") {
        return Some(archive(head));
    }
    let found = MARKS.iter().find(|mark| head.get(mark.at..).is_some_and(|rest| rest.starts_with(mark.octets)));
    // A bitmap begins with two letters, as a text may.
    let found = found.filter(|mark| mark.octets != b"BM" || head.contains(&0));
    found.map(|mark| mark.form).or_else(|| utf_16_without_mark(head))
}

/// A zip archive by the names of its first files: tables and texts of Office programs are archives too.
fn archive(head: &[u8]) -> FileForm {
    let has = |name: &[u8]| head.windows(name.len()).any(|part| part == name);
    let (what, helps) = if has(b"xl/") || has(b"application/vnd.oasis.opendocument.spreadsheet") {
        ("a table of a spreadsheet program (.xlsx, .ods)", SPREADSHEET)
    } else if has(b"word/") || has(b"application/vnd.oasis.opendocument.text") {
        ("a text of a word processor (.docx, .odt)", "save its table as CSV (UTF-8)")
    } else if has(b".kml") {
        (
            "a track of Google Earth (.kmz)",
            "make GPX of it: `gpsbabel -i kml -f FILE -o gpx -F NEW.gpx`, after `unzip FILE`",
        )
    } else if has(b"[Content_Types].xml") {
        ("a file of an Office program (an Excel table .xlsx, say)", SPREADSHEET)
    } else {
        ("a zip archive", "unpack it: `unzip FILE`")
    };
    FileForm { what, helps }
}

/// Text in UTF-16 without its mark: every second octet of the first line is 0.
fn utf_16_without_mark(head: &[u8]) -> Option<FileForm> {
    /// So many characters are no chance.
    const ENOUGH: usize = 8;
    let start = head.get(..2 * ENOUGH)?;
    let is_text = |first: usize| {
        start.chunks_exact(2).all(|pair| pair[1 - first] == 0 && (pair[first] >= 0x20 || pair[first] == b'\t'))
    };
    (is_text(0) || is_text(1)).then_some(FileForm { what: "text in UTF-16", helps: UTF_16 })
}
