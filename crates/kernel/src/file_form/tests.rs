//! What files are, by the octets that their formats define.

use super::*;

fn told(head: &[u8]) -> Option<String> {
    FileForm::of(head).map(|form| form.told(Path::new("a.bin")))
}

#[test]
fn files_of_other_programs_are_called_by_their_names_with_what_helps() {
    let zip = |name: &str| [b"PK\x03\x04\x14\0\x06\0\x08\0", &[0; 16][..], name.as_bytes()].concat();
    let tar = [&[b'a'; 257][..], b"ustar\x0000"].concat();
    let utf_16: Vec<u8> = "node,x_m,y_m\n".bytes().flat_map(|octet| [octet, 0]).collect();
    for (head, expected) in [
        (&b""[..], "empty; record or copy it again"),
        (b"\x1f\x8b\x08\0", "compressed with gzip; unpack it: `gunzip -k a.bin`"),
        (b"\xfd7zXZ\0\0", "compressed with xz"),
        (b"\x28\xb5\x2f\xfd\x04", "compressed with zstd"),
        (b"BZh91AY", "compressed with bzip2"),
        (b"7z\xbc\xaf\x27\x1c\0", "an archive of 7-Zip"),
        (&tar, "an archive of tar"),
        (&zip("data.csv"), "a zip archive; unpack it: `unzip a.bin`"),
        (
            &zip("[Content_Types].xml .. xl/workbook.xml"),
            "a table of a spreadsheet program (.xlsx, .ods); save each sheet",
        ),
        (b"\x34\xcd\xb2\xa1\x02\0\x04\0", "a modified pcap capture (magic number a1b2cd34); make a plain"),
        (b"\xa1\xb2\xcd\x34\0\x02\0\x04", "a modified pcap capture"),
        (b"#Format=4\r\n# SNA v2.2.0.4 SUS:20090709 ACT:819705\r\n", "a capture of a Daintree SNA, as KillerBee"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:00\n", "a pointer of Git LFS, not the file itself"),
        (b"#ROSBAG V2.0\n", "a bag of ROS 1"),
        (b"SQLite format 3\0", "a database of SQLite"),
        (b"PAR1\x15", "a Parquet table"),
        (b"%PDF-1.7\n", "a PDF document"),
        (b"\x89PNG\r\n\x1a\n", "a picture (PNG)"),
        (b"\xff\xd8\xff\xe0", "a picture (JPEG)"),
        (b"\xff\xfen\0o\0", "text in UTF-16; save it as UTF-8"),
        (&utf_16, "text in UTF-16"),
        (b"\xef\xbb\xbf<!DOCTYPE html>\n<html lang=\"en\">", "a web page"),
        (b"\n<HTML><body>", "a web page"),
        (
            b"<?xml version=\"1.0\"?>\n<!-- a -->\n<kml xmlns=\"http://www.opengis.net/kml/2.2\">",
            "a track of Google Earth",
        ),
        (b"<?xml version=\"1.0\"?><ns3:TrainingCenterDatabase>", "a track of a sports watch (TCX)"),
        (b"<robot name=\"r\">", "a document in XML of an unknown kind"),
        (b"{\"type\": \"FeatureCollection\", \"features\": []}", "GeoJSON, which has places without times"),
        (b"{\"a\": 1}", "JSON; write it as CSV"),
    ] {
        let found = told(head).unwrap_or_default();
        assert!(found.starts_with(expected), "{found}\nshould begin with: {expected}");
    }
}

#[test]
fn tables_paths_and_captures_are_none_of_these_files() {
    for head in [
        &b"stop,x_m,y_m\n0,0,0\n"[..],
        b"BM,x_m,y_m\n",
        b"\xef\xbb\xbfnode;x_m\n",
        b"# time x y z\n0 1 2 3\n",
        b"<?xml version=\"1.0\"?>\n<gpx version=\"1.1\">",
        b"<ns:gpx xmlns:ns=\"http://www.topografix.com/GPX/1/1\">",
        b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47",
        b"\x89MCAP0\r\n",
        b"\xd4\xc3\xb2\xa1\x02\0\x04\0",
        b"\x0a\x0d\x0d\x0a\x1c\0\0\0",
        b"<-50,-60",
    ] {
        assert_eq!(told(head), None, "{head:?}");
    }
}

#[test]
fn what_is_not_known_is_shown_as_it_begins() {
    assert_eq!(beginning(b"\x01\x02\xff"), "binary data that begin with the octets 01 02 ff");
    assert_eq!(beginning(b"\n hello, you\nthere"), "a text that begins with `hello, you`");
    assert_eq!(beginning(b"\n"), "a text that begins with ``");
    let folder = std::env::temp_dir();
    assert_eq!(seen(&folder.join("no-such-file-here")), "a file that cannot be read");
}

#[test]
fn the_first_tag_of_a_document_is_found_without_its_prefix() {
    for (text, expected) in [
        ("<gpx>", Some("gpx")),
        ("\u{feff}<?xml version=\"1.0\"?>\n<!-- <kml> -->\n<ns:gpx a=\"b\">", Some("gpx")),
        ("<!DOCTYPE html>", Some("html")),
        ("<svg/>", Some("svg")),
        ("a <gpx>", None),
        ("<", None),
        ("<3", None),
        ("<!-- never closed", None),
    ] {
        assert_eq!(root_of_xml(text).as_deref(), expected, "{text}");
    }
}
