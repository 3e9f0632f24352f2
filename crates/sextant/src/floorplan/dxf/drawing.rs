//! A drawing in DXF, as far as it may have walls: its unit, its layers, its blocks and its entities.
//!
//! Group codes as in "DXF Reference" (Autodesk, AutoCAD 2018).

use std::collections::BTreeMap;

use super::pairs::Pair;

/// What a drawing has.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Drawing {
    /// The code of the unit of lengths, `$INSUNITS`; 0 if it is not said.
    pub(super) unit: i64,
    /// Layers that are frozen or off.
    pub(super) hidden: Vec<String>,
    /// Those that are frozen: what is inserted on them is hidden, whatever its own layers are.
    pub(super) frozen: Vec<String>,
    /// Blocks by name.
    pub(super) blocks: BTreeMap<String, Block>,
    /// What is drawn.
    pub(super) entities: Vec<Entity>,
    /// What was not read, by the type of the entity.
    pub(super) unread: BTreeMap<String, usize>,
}

/// A part that is drawn where it is inserted.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Block {
    /// The point that is put where it is inserted.
    pub(super) base: [f64; 2],
    pub(super) entities: Vec<Entity>,
}

/// An entity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entity {
    pub(super) layer: String,
    pub(super) kind: Kind,
}

/// What an entity is. Lengths are those of the drawing; angles are in degrees, counterclockwise from x.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    /// Corners with the bulge of the part that follows: the tangent of a quarter of its angle.
    Line {
        corners: Vec<([f64; 2], f64)>,
        is_closed: bool,
    },
    Arc {
        center: [f64; 2],
        radius: f64,
        from_deg: f64,
        to_deg: f64,
        is_mirrored: bool,
    },
    Insert(Insert),
}

/// A block that is inserted, once or in rows and columns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Insert {
    pub(super) block: String,
    pub(super) at: [f64; 2],
    pub(super) scale: [f64; 2],
    pub(super) turn_deg: f64,
    /// Number of columns and rows, and their distances.
    pub(super) count: [i64; 2],
    pub(super) spacing: [f64; 2],
    pub(super) is_mirrored: bool,
}

/// The drawing in these groups.
pub(super) fn drawing(pairs: &[Pair<'_>]) -> Result<Drawing, String> {
    let mut drawing = Drawing::default();
    let mut at = 0;
    let mut sections = 0;
    while let Some(pair) = pairs.get(at) {
        at += 1;
        if pair.code != 0 || pair.value != "SECTION" {
            continue;
        }
        let Some(name) = pairs.get(at).filter(|name| name.code == 2) else { continue };
        let rest = &pairs[at + 1..];
        let end = rest.iter().position(|pair| pair.code == 0 && pair.value == "ENDSEC");
        let section = &rest[..end.unwrap_or(rest.len())];
        sections += 1;
        match name.value {
            "HEADER" => drawing.unit = unit(section)?,
            "TABLES" => drawing.read_layers(section)?,
            "BLOCKS" => drawing.read_blocks(section)?,
            "ENTITIES" => drawing.entities = read_all(&records(section), &mut drawing.unread)?,
            _ => {}
        }
        at += 1 + section.len();
    }
    if sections == 0 { Err("it has no sections: it is no DXF".to_owned()) } else { Ok(drawing) }
}

fn unit(header: &[Pair<'_>]) -> Result<i64, String> {
    let at = header.iter().position(|pair| pair.code == 9 && pair.value == "$INSUNITS");
    at.and_then(|at| header.get(at + 1)).map_or(Ok(0), Pair::whole)
}

/// The groups of one entity or table, the first of which says its type.
type Record<'a, 'b> = &'b [Pair<'a>];

fn records<'a, 'b>(section: &'b [Pair<'a>]) -> Vec<Record<'a, 'b>> {
    section.chunk_by(|_, next| next.code != 0).filter(|record| record[0].code == 0).collect()
}

/// The first value of a code.
fn of<'a, 'b>(record: Record<'a, 'b>, code: i32) -> Option<&'b Pair<'a>> {
    record.iter().find(|pair| pair.code == code)
}

fn number(record: Record<'_, '_>, code: i32, usual: f64) -> Result<f64, String> {
    of(record, code).map_or(Ok(usual), Pair::number)
}

fn whole(record: Record<'_, '_>, code: i32, usual: i64) -> Result<i64, String> {
    of(record, code).map_or(Ok(usual), Pair::whole)
}

fn point(record: Record<'_, '_>, x: i32) -> Result<[f64; 2], String> {
    Ok([number(record, x, 0.0)?, number(record, x + 10, 0.0)?])
}

fn name(record: Record<'_, '_>, code: i32) -> String {
    of(record, code).map_or_else(|| "0".to_owned(), |pair| pair.value.to_owned())
}

/// Whether two names of layers are the same: they do not differ by their case.
pub(super) fn is_same_layer(a: &str, b: &str) -> bool {
    a.to_lowercase() == b.to_lowercase()
}

impl Drawing {
    /// Reads which layers are frozen (flag 1), or off (negative colour).
    fn read_layers(&mut self, tables: &[Pair<'_>]) -> Result<(), String> {
        for record in records(tables).into_iter().filter(|record| record[0].value == "LAYER") {
            let is_frozen = whole(record, 70, 0)? & 1 != 0;
            if is_frozen {
                self.frozen.push(name(record, 2));
            }
            if is_frozen || whole(record, 62, 7)? < 0 {
                self.hidden.push(name(record, 2));
            }
        }
        Ok(())
    }

    /// Whether a layer is frozen.
    pub(super) fn is_frozen(&self, layer: &str) -> bool {
        self.frozen.iter().any(|frozen| is_same_layer(frozen, layer))
    }

    /// Reads the blocks that the drawing has itself.
    fn read_blocks(&mut self, section: &[Pair<'_>]) -> Result<(), String> {
        /// A block that stands for another drawing, or is laid over this one.
        const EXTERNAL: i64 = 4 | 8;
        let records = records(section);
        let mut rest = records.as_slice();
        while let Some(begin) = rest.iter().position(|record| record[0].value == "BLOCK") {
            let body = &rest[begin + 1..];
            let end = body.iter().position(|record| record[0].value == "ENDBLK").unwrap_or(body.len());
            if whole(rest[begin], 70, 0)? & EXTERNAL == 0 {
                let entities = read_all(&body[..end], &mut self.unread)?;
                self.blocks.insert(name(rest[begin], 2), Block { base: point(rest[begin], 10)?, entities });
            }
            rest = &body[end..];
        }
        Ok(())
    }
}

/// The entities that may be walls. Others are counted.
fn read_all(records: &[Record<'_, '_>], unread: &mut BTreeMap<String, usize>) -> Result<Vec<Entity>, String> {
    let mut entities = Vec::new();
    let mut rest = records.iter();
    while let Some(record) = rest.next() {
        let what = record[0].value;
        let mut leave_out = |what: &str| *unread.entry(what.to_owned()).or_default() += 1;
        // The parts of an entity of several records.
        let parts: Vec<Record<'_, '_>> = if what == "POLYLINE" || what == "INSERT" && whole(record, 66, 0)? != 0 {
            rest.by_ref().copied().take_while(|part| part[0].value != "SEQEND").collect()
        } else {
            Vec::new()
        };
        if whole(record, 67, 0)? != 0 {
            leave_out("entity of paper space");
            continue;
        }
        if whole(record, 60, 0)? == 1 {
            leave_out("invisible entity");
            continue;
        }
        let kind = match what {
            "LINE" => Some(Kind::Line {
                corners: vec![(point(record, 10)?, 0.0), (point(record, 11)?, 0.0)],
                is_closed: false,
            }),
            "LWPOLYLINE" => Some(light_polyline(record)?),
            "POLYLINE" => polyline(record, &parts)?,
            "ARC" | "CIRCLE" => Some(arc(record, what == "CIRCLE")?),
            "INSERT" => Some(Kind::Insert(insert(record)?)),
            "SEQEND" | "ATTDEF" | "ATTRIB" | "VIEWPORT" => continue,
            _ => None,
        };
        match kind {
            Some(kind) => entities.push(Entity { layer: name(record, 8), kind }),
            None => leave_out(what),
        }
    }
    Ok(entities)
}

/// Whether the entity is seen from below: its x goes the other way (arbitrary axis algorithm, for a normal along −z).
fn is_mirrored(record: Record<'_, '_>) -> Result<bool, String> {
    Ok(number(record, 230, 1.0)? < 0.0)
}

/// The corners seen from above.
fn mirrored(corners: Vec<([f64; 2], f64)>, is_mirrored: bool) -> Vec<([f64; 2], f64)> {
    if !is_mirrored {
        return corners;
    }
    corners.into_iter().map(|([x, y], bulge)| ([-x, y], -bulge)).collect()
}

fn light_polyline(record: Record<'_, '_>) -> Result<Kind, String> {
    let mut corners: Vec<([f64; 2], f64)> = Vec::new();
    for pair in record {
        match (pair.code, corners.last_mut()) {
            (10, _) => corners.push(([pair.number()?, 0.0], 0.0)),
            (20, Some((corner, _))) => corner[1] = pair.number()?,
            (42, Some((_, bulge))) => *bulge = pair.number()?,
            _ => {}
        }
    }
    let is_closed = whole(record, 70, 0)? & 1 != 0;
    Ok(Kind::Line { corners: mirrored(corners, is_mirrored(record)?), is_closed })
}

/// A polyline of the old form; `None` for meshes.
fn polyline(record: Record<'_, '_>, vertices: &[Record<'_, '_>]) -> Result<Option<Kind>, String> {
    const MESHES: i64 = 16 | 64;
    /// A vertex of the frame of a spline, which is not on the line.
    const FRAME: i64 = 16;
    let flags = whole(record, 70, 0)?;
    if flags & MESHES != 0 {
        return Ok(None);
    }
    let mut corners = Vec::new();
    for vertex in vertices.iter().filter(|vertex| vertex[0].value == "VERTEX") {
        if whole(vertex, 70, 0)? & FRAME == 0 {
            corners.push((point(vertex, 10)?, number(vertex, 42, 0.0)?));
        }
    }
    Ok(Some(Kind::Line { corners: mirrored(corners, is_mirrored(record)?), is_closed: flags & 1 != 0 }))
}

fn arc(record: Record<'_, '_>, is_circle: bool) -> Result<Kind, String> {
    let angle = |code: i32, of_circle: f64| if is_circle { Ok(of_circle) } else { number(record, code, of_circle) };
    Ok(Kind::Arc {
        center: point(record, 10)?,
        radius: number(record, 40, 0.0)?,
        from_deg: angle(50, 0.0)?,
        to_deg: angle(51, 360.0)?,
        is_mirrored: is_mirrored(record)?,
    })
}

fn insert(record: Record<'_, '_>) -> Result<Insert, String> {
    Ok(Insert {
        block: name(record, 2),
        at: point(record, 10)?,
        scale: [number(record, 41, 1.0)?, number(record, 42, 1.0)?],
        turn_deg: number(record, 50, 0.0)?,
        count: [whole(record, 70, 1)?.max(1), whole(record, 71, 1)?.max(1)],
        spacing: [number(record, 44, 0.0)?, number(record, 45, 0.0)?],
        is_mirrored: is_mirrored(record)?,
    })
}
