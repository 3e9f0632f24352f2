//! Random numbers of applications.

use sextant_channel::Position;
use sextant_sim::{Application, Port};

use crate::network;

const DRAWS: u64 = 6000;
const CHOICES: usize = 6;

/// Draws numbers and choices at the start.
#[derive(Clone, Debug, Default, PartialEq)]
struct Drawer {
    numbers: Vec<f64>,
    choices: Vec<usize>,
}

impl Application for Drawer {
    fn started(&mut self, port: &mut Port<'_>) {
        self.numbers = (0..DRAWS).map(|number| port.uniform(number)).collect();
        self.choices = (0..DRAWS).map(|number| port.choice(number, CHOICES)).collect();
        assert_eq!(port.choice(0, 1), 0);
    }
}

/// What this many stations draw.
fn draw(stations: usize, seed: u64) -> Vec<Drawer> {
    let places = vec![Position::ORIGIN; stations];
    let setup = network::engine(&places, network::link(1.0, network::prompt()), seed);
    network::run(setup, vec![Drawer::default(); stations]).applications
}

#[test]
fn draws_depend_on_seed_station_and_number_alone() {
    let drawn = draw(2, 1);
    assert_eq!(drawn, draw(3, 1)[..2]);
    assert_ne!(drawn[0].numbers, drawn[1].numbers);
    assert_ne!(drawn[0].choices, drawn[1].choices);
    assert_ne!(drawn, draw(2, 2));
}

#[test]
fn numbers_and_choices_are_uniform() {
    let [drawer] = &draw(1, 1)[..] else { panic!("one station") };
    let mut by_choice = [0_u32; CHOICES];
    let mut by_sixth = [0_u32; CHOICES];
    for (&number, &choice) in drawer.numbers.iter().zip(&drawer.choices) {
        assert!(number > 0.0 && number < 1.0);
        by_choice[choice] += 1;
        let sixth = (1..CHOICES).take_while(|&sixth| number >= sixth as f64 / CHOICES as f64).count();
        by_sixth[sixth] += 1;
    }
    for counts in [by_choice, by_sixth] {
        let expected = DRAWS as f64 / CHOICES as f64;
        let chi_square: f64 = counts.iter().map(|&n| (f64::from(n) - expected).powi(2) / expected).sum();
        // The upper 1e-5 of chi-square with 5 degrees of freedom.
        assert!(chi_square < 30.9, "{counts:?}");
    }
}
