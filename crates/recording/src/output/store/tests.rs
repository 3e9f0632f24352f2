//! Parts that are written, cut off and read again.

use super::*;

const RANGE: NumberRange = NumberRange { start: 0, end: 9 };

fn shared(folder: &Path, identity: &str) -> Store {
    Store::shared(ForeignFolder::new(folder), folder.to_owned(), identity)
}

fn text(store: &Store, part: PartName) -> String {
    all(&mut store.read(part).unwrap().unwrap())
}

fn all(rows: &mut PartRows) -> String {
    let mut text = Vec::new();
    while let Some(block) = rows.next_block().unwrap() {
        text.extend_from_slice(block.rows);
    }
    String::from_utf8(text).unwrap()
}

/// Rows with line feeds, nothing and much in them.
fn blocks_of_rows() -> Vec<String> {
    let long = "1,2,".repeat(3000);
    ["0,0,,0.5\n", "1,0,\"a\nb\"\n2,0,,\n", "", &long, "3,0,,é\n"].map(str::to_owned).to_vec()
}

/// A store with one unfinished part, which has these blocks.
fn with_blocks(folder: &Path, blocks: &[String]) -> (Store, PartName) {
    let store = shared(folder, "this");
    let mut part = store.begin(RANGE).unwrap();
    for (wall_s, rows) in (1_u8..).zip(blocks) {
        part.append(rows.as_bytes(), wall_s.into()).unwrap();
    }
    part.sync().unwrap();
    (store, part.name())
}

#[test]
fn what_was_appended_is_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = blocks_of_rows();
    let (store, part) = with_blocks(folder.path(), &blocks);
    let mut rows = store.read(part).unwrap().unwrap();
    assert_eq!((all(&mut rows), rows.wall_s()), (blocks.concat(), 5.0));
    assert_eq!(rows.next_block().unwrap(), None, "it is over");
    let next = store.begin(RANGE).unwrap().name();
    assert_eq!(store.parts().unwrap(), [part, next], "each process has its own file");
    assert_eq!((part.unfinished, next.unfinished), (Some(1), Some(2)));
    assert!(matches!(shared(folder.path(), "other").read(part), Err(StoreError::Other { .. })));
    store.remove(part);
    assert!(store.read(part).unwrap().is_none(), "another process finished it");
}

#[test]
fn of_a_part_that_was_cut_off_anywhere_all_whole_blocks_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = ["0,0,,0.5\n", "1,0,\"a\nb\"\n2,0,,\n", "3,0,,1\n"].map(str::to_owned);
    let (store, part) = with_blocks(folder.path(), &blocks);
    let path = store.path(part);
    let whole = std::fs::read(&path).unwrap();
    let mut ends = vec![head("this").len()];
    for (wall_s, rows) in (1_u8..).zip(&blocks) {
        ends.push(ends[ends.len() - 1] + block(rows.as_bytes(), wall_s.into()).len());
    }
    assert_eq!(ends.last(), Some(&whole.len()));
    for cut in 0..=whole.len() {
        let kept = ends.iter().filter(|end| **end <= cut).count().saturating_sub(1);
        std::fs::write(&path, &whole[..cut]).unwrap();
        assert_eq!(text(&store, part), blocks[..kept].concat(), "cut at {cut}");
        // Octets that did not reach the disk before a power failure are zeros.
        let mut zeros = whole.clone();
        zeros[cut..].fill(0);
        std::fs::write(&path, &zeros).unwrap();
        assert_eq!(text(&store, part), blocks[..kept].concat(), "zeros from {cut}");
    }
    for at in ends[0]..whole.len() {
        let mut changed = whole.clone();
        changed[at] ^= 1;
        std::fs::write(&path, &changed).unwrap();
        let before = ends.iter().filter(|end| **end <= at).count() - 1;
        assert_eq!(text(&store, part), blocks[..before].concat(), "octet {at} is another one");
    }
}

#[test]
fn rows_are_read_again_from_where_they_stand_also_if_the_part_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let blocks = blocks_of_rows();
    let (store, part) = with_blocks(folder.path(), &blocks);
    let other = shared(folder.path(), "this");
    let mut own = store.begin(RANGE).unwrap();
    let mut places = vec![RowPlace { part: own.name(), start: own.append(b"9,0,,1\n", 1.0).unwrap(), length: 7 }];
    let mut rows = store.read(part).unwrap().unwrap();
    while let Some(RowBlock { start, rows }) = rows.next_block().unwrap() {
        places.push(RowPlace { part, start, length: rows.len() });
    }
    store.keep_open(rows).unwrap();
    store.finish(RANGE, [Ok(blocks.concat().into_bytes())], 1.0).unwrap();
    let whole = PartName { range: RANGE, unfinished: None };
    let mut found = store.read(whole).unwrap().unwrap();
    let start = found.next_block().unwrap().unwrap().start;
    let length = blocks.concat().len();
    places.push(RowPlace { part: whole, start, length });
    [part, own.name()].into_iter().for_each(|part| store.remove(part));
    let texts = [vec!["9,0,,1\n".to_owned()], blocks.clone(), vec![blocks.concat()]].concat();
    for (place, text) in places.iter().zip(&texts).chain(places.iter().zip(&texts).rev()) {
        let mut rows = Vec::new();
        store.read_rows(*place, &mut rows).unwrap();
        assert_eq!(&String::from_utf8(rows).unwrap(), text, "{place:?}");
    }
    assert!(matches!(other.read_rows(places[0], &mut Vec::new()), Err(StoreError::Read { .. })));
}

#[test]
fn a_finished_part_that_was_cut_or_changed_has_only_the_rows_before() {
    let folder = tempfile::tempdir().unwrap();
    let store = shared(folder.path(), "this");
    let rows = ["0,0,,0.25\n", "1,0,,0.125\n"];
    store.finish(RANGE, rows.map(|rows| Ok(rows.into())), 1.0).unwrap();
    let part = PartName { range: RANGE, unfinished: None };
    let whole = std::fs::read(store.path(part)).unwrap();
    let first = head("this").len() + block(rows[0].as_bytes(), 1.0).len();
    for cut in first..whole.len() {
        std::fs::write(store.path(part), &whole[..cut]).unwrap();
        assert_eq!(text(&store, part), rows[0], "cut at {cut}");
        let mut changed = whole.clone();
        changed[cut] ^= 1;
        std::fs::write(store.path(part), &changed).unwrap();
        assert_eq!(text(&store, part), rows[0], "octet {cut} is another one");
    }
}

#[test]
fn other_files_are_no_parts() {
    let folder = tempfile::tempdir().unwrap();
    let (store, part) = with_blocks(folder.path(), &[]);
    for other in ["hello\n", "sextant-part-1,this,0.000\n", "x"] {
        std::fs::write(store.path(part), other).unwrap();
        assert!(matches!(store.read(part), Err(StoreError::Invalid { .. })), "{other}");
    }
    std::fs::write(folder.path().join("000000000-000000009.csv.1-0.part"), "").unwrap();
    assert_eq!(store.parts().unwrap(), [part], "what is being written is left out");
    std::fs::write(folder.path().join("0000007.csv"), "").unwrap();
    assert!(matches!(store.parts(), Err(StoreError::Invalid { .. })));
}

#[test]
fn a_finished_part_has_all_rows_and_how_long_it_took() {
    let folder = tempfile::tempdir().unwrap();
    let store = shared(folder.path(), "this");
    store.finish(RANGE, [Ok(b"0,0,,1\n".to_vec())], 2.5).unwrap();
    let part = PartName { range: RANGE, unfinished: None };
    assert_eq!(store.parts().unwrap(), [part]);
    let expected = [head("this"), block(b"0,0,,1\n", 2.5)].concat();
    assert_eq!(std::fs::read(store.path(part)).unwrap(), expected);
    let mut rows = store.read(part).unwrap().unwrap();
    assert_eq!((all(&mut rows).as_str(), rows.wall_s()), ("0,0,,1\n", 2.5));
    std::fs::write(store.path(part), "").unwrap();
    assert!(matches!(store.read(part), Err(StoreError::Invalid { .. })), "it is renamed when it is whole");
}

#[test]
fn work_that_is_done_alone_is_done_by_one_process_and_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let store = folder.path().join("table.csv.parts");
    let (first, begun) = Store::alone(&store, "this").unwrap();
    assert_eq!((begun, first.parts().unwrap()), (Begun::Now, vec![]));
    assert!(matches!(Store::alone(&store, "this"), Err(StoreError::Busy { .. })));
    assert!(matches!(Store::alone(&store, "other"), Err(StoreError::Other { .. })));
    drop(first);
    assert_eq!(Store::alone(&store, "this").unwrap().1, Begun::Before);
    remove(&store).unwrap();
    assert!(!store.exists());
}
