//! Which cells of a floor are occupied.

use super::image::Picture;

/// Darker than this is a wall in a picture.
const DARK: u8 = 128;
/// Darker than this is nearly a wall.
const NEARLY_DARK: u8 = 192;

/// So many of all, in percent.
pub(super) fn share(part: usize, all: usize) -> f64 {
    100.0 * part as f64 / all.max(1) as f64
}

/// Cells of a floor, row by row from the top.
pub(super) struct Occupancy {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) cells: Vec<bool>,
    /// What a wall is in the picture, and how many pixels nearly are, for the user.
    pub(super) rule: String,
    /// Length of a cell (m).
    pub(super) pixel_m: f64,
    /// Where the lower left corner is (m).
    pub(super) origin_m: [f64; 2],
    /// How the cells are turned about that corner (rad).
    pub(super) turn_rad: f64,
}

impl Occupancy {
    /// The dark pixels of a picture.
    pub(super) fn of_image(picture: &Picture, pixel_m: f64, origin_m: [f64; 2]) -> Self {
        let cells = picture.grey.iter().map(|&grey| grey < DARK).collect();
        let nearly = picture.grey.iter().filter(|&&grey| (DARK..NEARLY_DARK).contains(&grey)).count();
        let nearly = share(nearly, picture.grey.len());
        let rule = format!(
            "pixels darker than {DARK} of 255 are walls; {nearly:.1} % of the pixels are at {DARK} to {}",
            NEARLY_DARK - 1
        );
        Self { rule, width: picture.width, height: picture.height, cells, pixel_m, origin_m, turn_rad: 0.0 }
    }

    /// The cells.
    pub(super) fn mask(&self) -> Mask {
        Mask { width: self.width, height: self.height, cells: self.cells.clone() }
    }

    /// Where a place in cells is on the floor (m): cell 0 of row 0 has its middle at (0, 0).
    pub(super) fn place_m(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let (x, y) = ((column + 0.5) * self.pixel_m, (self.height as f64 - 0.5 - row) * self.pixel_m);
        let (sin, cos) = libm::sincos(self.turn_rad);
        [self.origin_m[0] + cos * x - sin * y, self.origin_m[1] + sin * x + cos * y]
    }
}

/// A set of cells.
#[derive(Clone)]
pub(super) struct Mask {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) cells: Vec<bool>,
}

/// The eight neighbours of a cell, clockwise from the one above.
const AROUND: [(isize, isize); 8] = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1)];

impl Mask {
    /// An empty set of the same size.
    pub(super) fn empty_like(&self) -> Self {
        Self { width: self.width, height: self.height, cells: vec![false; self.cells.len()] }
    }

    /// The neighbour of a cell in a direction (0 above, clockwise), if there is one in the picture.
    pub(super) fn neighbour(&self, cell: usize, direction: usize) -> Option<usize> {
        let (dx, dy) = AROUND[direction];
        let column = (cell % self.width).checked_add_signed(dx).filter(|&column| column < self.width)?;
        let row = (cell / self.width).checked_add_signed(dy).filter(|&row| row < self.height)?;
        Some(row * self.width + column)
    }

    /// Whether the neighbour of a cell in a direction is in the set.
    pub(super) fn has_neighbour(&self, cell: usize, direction: usize) -> bool {
        self.neighbour(cell, direction).is_some_and(|neighbour| self.cells[neighbour])
    }

    /// Whether the cell of this column and row, which may be beyond the picture, is in the set.
    pub(super) fn has_at(&self, [column, row]: [f64; 2]) -> bool {
        let is_inside = column >= 0.0 && row >= 0.0 && column < self.width as f64 && row < self.height as f64;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "within the picture")]
        let is_in = is_inside && self.cells[row as usize * self.width + column as usize];
        is_in
    }

    /// The neighbours of a cell in the set, those beside it before those at its corners.
    pub(super) fn neighbours(&self, cell: usize) -> impl Iterator<Item = usize> {
        [0, 2, 4, 6, 1, 3, 5, 7]
            .into_iter()
            .filter_map(move |direction| self.neighbour(cell, direction))
            .filter(|&cell| self.cells[cell])
    }

    /// The cells of the set.
    pub(super) fn members(&self) -> impl Iterator<Item = usize> {
        self.cells.iter().enumerate().filter(|(_, is_in)| **is_in).map(|(cell, _)| cell)
    }

    /// The parts of the set that hang together, also at corners.
    pub(super) fn components(&self) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.cells.len()];
        let mut components = Vec::new();
        for start in self.members() {
            if std::mem::replace(&mut seen[start], true) {
                continue;
            }
            let mut component = vec![start];
            let mut next = 0;
            while let Some(&cell) = component.get(next) {
                next += 1;
                for neighbour in self.neighbours(cell) {
                    if !std::mem::replace(&mut seen[neighbour], true) {
                        component.push(neighbour);
                    }
                }
            }
            components.push(component);
        }
        components
    }

    /// Where a cell is: column and row.
    pub(super) fn place(&self, cell: usize) -> [f64; 2] {
        [(cell % self.width) as f64, (cell / self.width) as f64]
    }

    /// The distance of each cell of the set from the next cell outside (cells), by the two passes of a chamfer with steps of 1 and √2;
    /// what is beyond the picture is outside.
    pub(super) fn depths(&self) -> Vec<f32> {
        let far = f32::MAX;
        let mut depths: Vec<f32> = self.cells.iter().map(|&is_in| if is_in { far } else { 0.0 }).collect();
        let diagonal = std::f32::consts::SQRT_2;
        for (order, directions) in [
            (false, [(0, 1.0), (7, diagonal), (1, diagonal), (6, 1.0)]),
            (true, [(4, 1.0), (3, diagonal), (5, diagonal), (2, 1.0)]),
        ] {
            for step in 0..depths.len() {
                let cell = if order { depths.len() - 1 - step } else { step };
                if depths[cell] > 0.0 {
                    let of = |(direction, length): (usize, f32)| {
                        self.neighbour(cell, direction).map_or(0.0, |neighbour| depths[neighbour]) + length
                    };
                    depths[cell] = directions.into_iter().map(of).fold(depths[cell], f32::min);
                }
            }
        }
        depths
    }
}
