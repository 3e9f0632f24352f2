#!/usr/bin/env python3
"""Makes ring-60ghz.csv: a code book of a 60 GHz array on a ring, from an array factor.

- 32 elements stand on a circle, half a wavelength apart along it. Each looks outwards and radiates as cos^1.2 of the angle from
  its normal, and 15 dB less behind it.
- 24 sectors point at azimuths 15 degrees apart, in an order without a pattern.
- A sector uses the 11 elements that look its way. Phases have two bits and a fault each, so that side lobes are high.
- Gains are relative decibels on azimuths 3 degrees apart, at elevation 0.

The same seed gives the same file: ring-60ghz.py > ring-60ghz.csv
"""

import cmath
import math
import random

SEED = 32
ELEMENTS = 32
SECTORS = 24
USED = 11
STEP_DEG = 3
RADIUS = 0.5 * ELEMENTS / (2 * math.pi)  # wavelengths
FLOOR_DB = -38.0


def element_db(off_rad):
    return max(12 * math.log10(max(math.cos(off_rad), 1e-9)), -15.0)


def phase(element_rad, azimuth_rad):
    return 2 * math.pi * RADIUS * math.cos(azimuth_rad - element_rad)


def weights(rng, aim_rad):
    elements = [2 * math.pi * (i + 0.5) / ELEMENTS for i in range(ELEMENTS)]
    near = sorted(elements, key=lambda element: 1 - math.cos(element - aim_rad))[:USED]
    steered = []
    for element in near:
        wanted = -phase(element, aim_rad) + rng.gauss(0.0, 0.3)
        steered.append((element, math.pi / 2 * round(wanted / (math.pi / 2))))
    return steered


def gain_db(steered, azimuth_rad):
    def field(element, shift):
        amplitude = 10 ** (element_db(azimuth_rad - element) / 20)
        return amplitude * cmath.exp(1j * (phase(element, azimuth_rad) + shift))

    total = sum(field(element, shift) for element, shift in steered)
    return max(10 * math.log10(max(abs(total) ** 2 / len(steered), 1e-9)), FLOOR_DB)


def main():
    rng = random.Random(SEED)
    print("# Made by ring-60ghz.py: a computed code book of 32 elements on a ring.")
    print("sector,azimuth_deg,elevation_deg,gain_db")
    aims = list(range(SECTORS))
    rng.shuffle(aims)
    patterns = [weights(rng, 2 * math.pi * aim / SECTORS) for aim in aims]
    for azimuth in range(-180, 180, STEP_DEG):
        for sector, steered in enumerate(patterns):
            print(f"{sector},{azimuth},0,{gain_db(steered, math.radians(azimuth)):.2f}")


main()
