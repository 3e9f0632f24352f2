#!/usr/bin/env python3
"""Makes router-60ghz.csv: a code book with the layout of a measured 60 GHz router, from an array factor.

Public measurements of such routers have 36 sectors with the identities 0 to 30 and 59 to 63, gains in relative decibels on a
grid of azimuths and elevations, directions that were never decoded, and a quasi-omnidirectional pattern with which the
router listens. This file has the same layout. Its values are computed, not measured:

- 32 elements on a grid of 8 by 4, half a wavelength apart, of which six are missing, as those of small arrays are.
- The sectors 0 to 30 point at azimuths from -75 to 75 degrees in three rows; 59 to 63 use few elements and are wide.
  Phases have two bits and a fault each, so that side lobes are as high as measured ones.
- An element radiates as cos^1.4 of the angle from its normal, and 18 dB less behind it.
- Quasi-omnidirectional: one element.
- Gaps: what is more than 24 dB below the strongest sector in its direction is lost with a probability that rises with the
  distance; behind the mast (azimuths from 162 on, elevations below 10) nothing was measured.

The same seed gives the same file: router-60ghz.py > router-60ghz.csv
"""

import cmath
import math
import random

SEED = 60
AZIMUTHS = [-180 + 9 * i for i in range(40)]
ELEVATIONS = [round(-10.8 + 5.4 * i, 1) for i in range(9)]
SECTORS = list(range(31)) + list(range(59, 64))
SPACING = 0.5
FLOOR_DB = -38.0


def direction(azimuth_deg, elevation_deg):
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    return (math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation))


def element_db(unit):
    front = 10 * math.log10(max(unit[0], 1e-9) ** 1.4)
    return max(front, -18.0)


def phase(place, unit):
    return 2 * math.pi * SPACING * (place[0] * unit[1] + place[1] * unit[2])


def weights(rng, elements, aim, faults_rad):
    steered = []
    for place in elements:
        wanted = -phase(place, aim) + rng.gauss(0.0, faults_rad)
        steered.append((place, math.pi / 2 * round(wanted / (math.pi / 2))))
    return steered


def gain_db(steered, unit):
    total = sum(cmath.exp(1j * (phase(place, unit) + shift)) for place, shift in steered)
    factor = 10 * math.log10(max(abs(total) ** 2 / len(steered), 1e-9))
    return factor + element_db(unit)


def main():
    rng = random.Random(SEED)
    places = [(column - 3.5, row - 1.5) for row in range(4) for column in range(8)]
    missing = rng.sample(range(len(places)), 6)
    places = [place for i, place in enumerate(places) if i not in missing]
    patterns = {}
    for number, sector in enumerate(SECTORS):
        if sector <= 30:
            column, row = number % 11, number // 11
            # Neighbours in azimuth do not have neighbouring identities, as in a real code book.
            azimuth = -75 + 15 * (column * 4 % 11)
            patterns[sector] = weights(rng, places, direction(azimuth, [0, 16, 32][row]), 0.35)
        else:
            few = rng.sample(places, 3)
            patterns[sector] = weights(rng, few, direction(rng.uniform(-60, 60), 8), 0.8)
    patterns["quasi_omni"] = [(places[0], 0.0)]

    print("# Made by router-60ghz.py: the layout of a measured code book, with computed values.")
    print("sector,azimuth_deg,elevation_deg,gain_db")
    for azimuth in AZIMUTHS:
        for elevation in ELEVATIONS:
            unit = direction(azimuth, elevation)
            gains = {name: gain_db(pattern, unit) for name, pattern in patterns.items()}
            strongest = max(gains.values())
            for name, gain in gains.items():
                lost = azimuth >= 162 and elevation < 10
                faint = strongest - gain - 24.0
                lost = lost or (name != "quasi_omni" and faint > 0 and rng.random() < min(0.06 * faint, 0.6))
                if not lost:
                    print(f"{name},{azimuth},{elevation:g},{max(gain, FLOOR_DB):.2f}")


main()
