"""Predicts one case and prints the plane averages of a field: library, bundle, cases file, case, field."""
import sys

from elrom import ElromError, Predictor


def main(library, bundle, cases, case, field):
    with Predictor(bundle, [field], library) as predictor:
        inputs = predictor.read_case(cases, case)
        print(f"{case}: {predictor.validity(inputs)[1]}")
        averages = predictor.predict(inputs)[0].mean(axis=1, dtype=float)
        heights = predictor.centres()[:, :, 2].mean(axis=1)
        print(f"{'z [m]':>10}  mean {field} [{predictor.units[0]}]")
        for height, average in zip(heights, averages):
            print(f"{height:10.2f}  {average:.6g}")


if __name__ == "__main__":
    if len(sys.argv) != 6:
        sys.exit("predict: arguments are: LIBRARY BUNDLE CASES CASE FIELD")
    try:
        main(*sys.argv[1:])
    except ElromError as error:
        sys.exit(f"predict: {error}")
