"""Predicts one case and prints the plane averages of a field: bundle, cases file, case, field [, file to write]."""
import sys

import elrom


def main(bundle, cases, name, field, *target):
    predictor = elrom.Predictor(bundle, [field])
    table = predictor.read_cases(cases)
    if name not in table:
        raise elrom.UsageError(f"no such case: {name}")
    prediction = predictor.predict(table[name])
    print(f"{name}: {prediction.assessment.reason}")
    heights = predictor.coordinates[:, :, 2].mean(axis=1, dtype=float)
    print(f"{'z [m]':>10}  mean {field} [{prediction.fields[0].unit}]")
    for height, average in zip(heights, prediction[field].mean(axis=1, dtype=float)):
        print(f"{height:10.2f}  {average:.6g}")
    for path in target:
        prediction.write(path)


if __name__ == "__main__":
    if len(sys.argv) not in (5, 6):
        sys.exit("predict: arguments are: BUNDLE CASES CASE FIELD [FILE.hdf]")
    try:
        main(*sys.argv[1:])
    except elrom.Error as error:
        print(f"predict: {error}", file=sys.stderr)
        sys.exit(error.status)
