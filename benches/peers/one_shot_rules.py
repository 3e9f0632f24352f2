"""One-shot contention of IEEE 802.15.4 nodes under two rules of carrier sense, apart from any simulator.

The channel is busy if a frame is on air at any instant of the assessment, as IEEE 802.15.4 and Sextant have it; or only if one is on air at its
end or begins within it, as `LrWpanPhy` of ns-3 has it: an assessment starts with a peak power of zero, and the end of a frame does not raise it.
Setting and columns are those of ns3_one_shot.py. Usage: one_shot_rules.py ROUNDS N:L..
"""

import heapq
import random
import sys

BACKOFF_US, ASSESSMENT_US, TURNAROUND_US = 320, 128, 192


def one_shot(nodes: int, octets: int, rounds: int, is_end_enough: bool) -> tuple[float, float, float]:
    """The shares of the frames that overlap no other one and that are given up, and the mean end of the former (ms)."""
    draw = random.Random(1).randrange
    good, given_up, ends_us = 0, 0, 0
    for _ in range(rounds):
        # Ends of assessments, with the node, its assessments so far, and its exponent.
        ahead = [(BACKOFF_US * draw(8) + ASSESSMENT_US, node, 0, 3) for node in range(nodes)]
        heapq.heapify(ahead)
        frames: list[tuple[int, int]] = []
        while ahead:
            now, node, assessed, exponent = heapq.heappop(ahead)
            start = now - ASSESSMENT_US
            seen = [(begin, end) for begin, end in frames if begin < now and end > start]
            if any(end > now or begin >= start for begin, end in seen) if is_end_enough else seen:
                if assessed == 4:
                    given_up += 1
                    continue
                exponent = min(exponent + 1, 5)
                again = now + BACKOFF_US * draw(2**exponent) + ASSESSMENT_US
                heapq.heappush(ahead, (again, node, assessed + 1, exponent))
            else:
                begin = now + TURNAROUND_US
                frames.append((begin, begin + 32 * (6 + octets)))
        for one, (begin, end) in enumerate(frames):
            if not any(other != one and low < end and high > begin for other, (low, high) in enumerate(frames)):
                good += 1
                ends_us += end
    return good / rounds / nodes, given_up / rounds / nodes, ends_us / max(good, 1) / 1000


if __name__ == "__main__":
    for pair in sys.argv[2:]:
        nodes, octets = map(int, pair.split(":"))
        for rule, is_end_enough in ("any instant", False), ("its end", True):
            shares = one_shot(nodes, octets, int(sys.argv[1]), is_end_enough)
            print(nodes, octets, rule, *(f"{value:.4f}" for value in shares))
