//! Names beside dots, placed so that they overlap neither each other nor the dots.

use super::palette::THREAD;
use super::picture::{Anchor, Area, Picture, Point, Stroke, TextStyle, text_width};

/// Gap between a dot and its name (px).
const GAP: f64 = 2.5;
/// Space left and right of a name (px).
const SIDE: f64 = 1.5;
/// Height of the box of a name in ems.
const LINE: f64 = 1.15;
/// Directions in which a name may stand, beginning with the right side.
const DIRECTIONS: u8 = 16;
/// Distances from the dot at which a name may stand; from the second on a line leads there.
const RINGS: u8 = 10;
/// Half the side of a cross (px).
pub(crate) const MARK: f64 = 2.8;
/// Distance of two rings (px).
const RING: f64 = 8.0;
/// From a name that is not beside its dot to the dot.
const LEADER: Stroke = Stroke::new(THREAD, 0.7);

/// A name and where it stands.
#[derive(Clone, Debug, PartialEq)]
struct Label {
    text: String,
    /// Its box.
    area: Area,
    /// From the dot to the name, if it is not beside the dot.
    leader: Option<[Point; 2]>,
}

/// The names of dots within a frame.
#[derive(Clone, Debug)]
pub(crate) struct Labels {
    frame: Area,
    style: TextStyle,
    taken: Vec<Area>,
    labels: Vec<Label>,
    left_out: usize,
}

impl Labels {
    /// The names of `dots`, all with the same `radius` (px); the first ones get the best places. They keep clear of the
    /// crosses at `marks` too.
    pub(crate) fn of<'a>(
        dots: impl IntoIterator<Item = (Point, &'a str)> + Clone,
        radius: f64,
        marks: impl IntoIterator<Item = Point>,
        frame: Area,
        style: TextStyle,
    ) -> Self {
        let square = |center: Point, radius: f64| Area {
            left: center.x - radius,
            top: center.y - radius,
            width: 2.0 * radius,
            height: 2.0 * radius,
        };
        let of_dots = dots.clone().into_iter().map(|(at, _)| square(at, radius));
        let taken = of_dots.chain(marks.into_iter().map(|at| square(at, MARK))).collect();
        let mut labels = Self { frame, style, taken, labels: Vec::new(), left_out: 0 };
        for (at, text) in dots {
            labels.add(at, radius, text);
        }
        labels
    }

    /// Number of names for which there was no space.
    pub(crate) fn left_out(&self) -> usize {
        self.left_out
    }

    pub(crate) fn draw(&self, picture: &mut Picture) {
        for label in &self.labels {
            if let Some([from, to]) = label.leader {
                picture.line(from, to, LEADER);
            }
        }
        for Label { text, area, .. } in &self.labels {
            let at = Point::new(area.left + area.width / 2.0, area.top + area.height / 2.0);
            picture.text(at, text, Anchor::Middle, self.style);
        }
    }

    fn add(&mut self, at: Point, radius: f64, text: &str) {
        let (width, height) = (text_width(text, self.style) + 2.0 * SIDE, LINE * self.style.em);
        for ring in 0..RINGS {
            for direction in 0..DIRECTIONS {
                let angle = f64::from(direction) * std::f64::consts::TAU / f64::from(DIRECTIONS);
                let (up, across) = libm::sincos(angle);
                let away = radius + GAP + RING * f64::from(ring);
                // The box touches the ring with the side that faces the dot.
                let x = at.x + across * away + (across.clamp(-0.5, 0.5) - 0.5) * width;
                let y = at.y - up * away - (up.clamp(-0.5, 0.5) + 0.5) * height;
                let area = Area { left: x, top: y, width, height };
                let edge = Point::new(at.x + across * radius, at.y - up * radius);
                let near = Point::new(edge.x.clamp(x, x + width), edge.y.clamp(y, y + height));
                let leader = (ring > 0).then_some([edge, near]);
                if self.is_free(area) && leader.is_none_or(|leader| self.is_clear(leader)) {
                    self.taken.push(area);
                    self.taken.extend(leader.iter().flat_map(|leader| crumbs(*leader)));
                    self.labels.push(Label { text: text.to_owned(), area, leader });
                    return;
                }
            }
        }
        self.left_out += 1;
    }

    fn is_free(&self, area: Area) -> bool {
        let Area { left, top, width, height } = self.frame;
        let is_within =
            area.left >= left && area.top >= top && area.right() <= left + width && area.bottom() <= top + height;
        is_within && !self.taken.iter().any(|taken| overlap(taken, &area))
    }

    fn is_clear(&self, leader: [Point; 2]) -> bool {
        // The first crumb may be on a dot that touches the own one.
        !crumbs(leader).skip(1).any(|crumb| self.taken.iter().any(|taken| overlap(taken, &crumb)))
    }
}

/// Small boxes along a line.
fn crumbs([from, to]: [Point; 2]) -> impl Iterator<Item = Area> {
    const STEPS: u8 = 8;
    (0..STEPS).map(move |i| {
        let share = (f64::from(i) + 0.5) / f64::from(STEPS);
        let (x, y) = (from.x + share * (to.x - from.x), from.y + share * (to.y - from.y));
        Area { left: x - 0.5, top: y - 0.5, width: 1.0, height: 1.0 }
    })
}

fn overlap(a: &Area, b: &Area) -> bool {
    a.left < b.right() && b.left < a.right() && a.top < b.bottom() && b.top < a.bottom()
}

#[cfg(test)]
mod tests {
    use plotters::style::RGBColor;

    use super::super::picture::Weight;
    use super::*;

    const STYLE: TextStyle = TextStyle { em: 9.0, weight: Weight::Regular, color: RGBColor(0, 0, 0) };

    fn labels(side: u8, step: f64) -> Labels {
        let dots: Vec<(Point, String)> = (0..side * side)
            .map(|i| {
                (Point::new(30.0 + step * f64::from(i % side), 30.0 + step * f64::from(i / side)), format!("n{i}"))
            })
            .collect();
        let width = 60.0 + step * f64::from(side - 1);
        let frame = Area { left: 0.0, top: 0.0, width, height: width };
        Labels::of(dots.iter().map(|(at, name)| (*at, name.as_str())), 3.0, [Point::new(30.0, 30.0)], frame, STYLE)
    }

    #[test]
    fn names_overlap_neither_each_other_nor_a_dot_and_stay_within_the_frame() {
        for step in [12.0, 20.0, 60.0] {
            let labels = labels(8, step);
            for (i, label) in labels.labels.iter().enumerate() {
                let area = label.area;
                assert!(labels.labels[..i].iter().all(|other| !overlap(&other.area, &area)), "{label:?}");
                assert!(labels.taken[..64].iter().all(|dot| !overlap(dot, &area)), "{label:?}");
                assert!(area.left >= 0.0 && area.right() <= labels.frame.width, "{label:?}");
                assert!(area.top >= 0.0 && area.bottom() <= labels.frame.height, "{label:?}");
            }
            assert_eq!(labels.labels.len() + labels.left_out, 64);
        }
    }

    #[test]
    fn with_space_all_names_are_beside_their_dots_and_without_space_some_are_left_out() {
        let wide = labels(6, 60.0);
        assert!(wide.left_out == 0 && wide.labels.iter().all(|label| label.leader.is_none()));
        assert!(labels(10, 8.0).left_out > 50);
    }
}
