// Curves of sweeps and exact numbers, without a browser.

import { strict as assert } from "node:assert";
import { comparisons, curvesOf, curvesOfMaps, found, meanOf, shareOf } from "../src/curves.js";
import { exact } from "../src/format.js";
import { documentOf } from "../src/payload.js";

const numbers = (name, values) => ({ name, values: { numbers: Float64Array.from(values) } });

export async function sweepInNode(test) {
  await test("values that differ after rounding only are different curves", () => {
    const rate = numbers("traffic.rate", [0.12341, 0.12341, 0.12344, 0.12344]);
    const across = numbers("count", [1, 2, 1, 2]);
    const sweep = { rows: 4, settings: [rate, across], students_t_975: [12.7] };
    const { curves } = curvesOf(sweep, across, numbers("mac.prr", [0.1, 0.2, 0.3, 0.4]));
    assert.deepEqual(curves.map(({ name, means }) => [name, means.map((mean) => mean.mean)]), [["rate 0.12341", [0.1, 0.2]], ["rate 0.12344", [0.3, 0.4]]]);
    assert.deepEqual([exact(12345), exact(0.5), exact(-1e-7), exact(NaN)], ["12\u202f345", "0.5", "−1e−7", "–"]);
  });
  await test("a mean says of how many runs it is, and one run has no interval", () => {
    assert.deepEqual(meanOf([3], []), { mean: 3, low: null, high: null, n: 1 });
    const sweep = { rows: 3, settings: [], students_t_975: [12.7, 4.3] };
    const { curves } = curvesOf(sweep, null, numbers("mapped", [1, NaN, 3]));
    assert.equal(curves[0].means[0].n, 2);
  });
  await test("an outcome is a share, whose interval is exact and stays from 0 to 1", () => {
    const near = (found, expected) => assert.ok(Math.abs(found - expected) < 1e-6, `${found}, not ${expected}`);
    // Of 20 that all happened, the low end is the 20th root of 0.025.
    const all = shareOf(Array(20).fill(1));
    near(all.low, 0.025 ** (1 / 20));
    assert.deepEqual([all.mean, all.high, all.n], [1, 1, 20]);
    const none = shareOf(Array(20).fill(0));
    near(none.high, 1 - 0.025 ** (1 / 20));
    assert.deepEqual([none.mean, none.low], [0, 0]);
    const outcomes = { ...numbers("applications.detarsk.captured", [1, 1, 0, 1, 1]), is_outcome: true };
    const { low, high, mean } = curvesOf({ rows: 5, settings: [], students_t_975: [12.7, 4.3, 3.2, 2.8] }, null, outcomes).curves[0].means[0];
    near(mean, 0.8);
    near(low, 0.283582);
    near(high, 0.994949);
    const many = shareOf([...Array(900).fill(1), ...Array(100).fill(0)]);
    assert.ok(many.low > 0.87 && many.low < 0.89 && many.high > 0.91 && many.high < 0.92, JSON.stringify(many));
    assert.deepEqual(shareOf([1]), { mean: 1, low: null, high: null, n: 1 });
  });
  await test("a measure of several maps is one chart, with a curve for each of them", () => {
    const of = (map, measure, values, label) => ({ ...numbers(`${map}.${measure}`, values), label: label && `${map}: ${label}`, of_map: { map, measure, label } });
    const across = numbers("count", [1, 2]);
    const measures = [of("a", "error", [1, 2], "Error (m)"), of("b", "error", [3, 4], "Error (m)"), of("a", "rounds", [5, 5]), of("a", "position_error_m.mean", [1, 1], "Mean (m)"), numbers("mac.prr", [1, 1])];
    const [error, ...others] = comparisons(measures);
    assert.deepEqual([error.name, error.label, others.length], ["error", "Error (m)", 0]);
    const { xs, curves } = curvesOfMaps({ rows: 2, settings: [across], students_t_975: [12.7] }, across, error);
    assert.deepEqual([xs, curves.map(({ name, means }) => [name, means.map((mean) => mean.mean)])], [[1, 2], [["a", [1, 2]], ["b", [3, 4]]]]);
    assert.deepEqual(found(measures, " ERROR b").map(({ name }) => name), ["b.error"]);
    const second = comparisons([...measures, of("b", "position_error_m.mean", [2, 2], "Mean (m)")]).map(({ name }) => name);
    assert.deepEqual(second, ["position_error_m.mean", "error"]);
    assert.equal(found(measures, "").length, 5);
    assert.equal(found(measures, "nothing").length, 0);
  });
  await test("large whole numbers of a summary keep all digits", () => {
    const summary = '{"scenario":{"seed":18446744073709551615,"name":"a 9007199254740993 \\"b"},"n":[-9007199254740993,12,1.5e300,9007199254740993.5,0.12345678901234567,1e25]}';
    assert.deepEqual(documentOf(JSON.stringify({ summary })).summary,
      { scenario: { seed: "18446744073709551615", name: 'a 9007199254740993 "b' }, n: ["-9007199254740993", 12, 1.5e300, 9007199254740994, 0.12345678901234567, 1e25] });
  });
}
