/* Predicts one case and prints the plane averages of a field: bundle, cases file, case,
 * field [, file to write]. */
#include <elrom/model/elrom.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static int failed(void) {
  fprintf(stderr, "predict: %s\n", elrom_last_error());
  return 1;
}

static void print_profile(const elrom_predictor* predictor, const double* xyz, const float* values) {
  const size_t n_columns = elrom_n_columns(predictor);
  printf("%10s  mean %s [%s]\n", "z [m]", elrom_field_name(predictor, 0), elrom_field_unit(predictor, 0));
  for (size_t plane = 0; plane < elrom_n_planes(predictor); ++plane) {
    double sum = 0, height = 0;
    for (size_t column = 0; column < n_columns; ++column) {
      sum += values[plane * n_columns + column];
      height += xyz[(plane * n_columns + column) * 3 + 2];
    }
    printf("%10.2f  %.6g\n", height / (double)n_columns, sum / (double)n_columns);
  }
}

static int predict(const elrom_predictor* predictor, const char* cases, const char* name, const char* file) {
  const size_t n_cells = elrom_n_planes(predictor) * elrom_n_columns(predictor);
  double* inputs = malloc(elrom_n_inputs(predictor) * sizeof *inputs);
  double* xyz = malloc(n_cells * 3 * sizeof *xyz);
  float* values = malloc(elrom_n_fields(predictor) * n_cells * sizeof *values);
  int verdict = 0, status = 1;
  char reason[512];
  if (inputs != NULL && xyz != NULL && values != NULL) {
    status = elrom_read_case(predictor, cases, name, inputs);
    if (status == 0) status = elrom_validity(predictor, inputs, &verdict, reason, sizeof reason);
    if (status == 0) status = elrom_cell_centres(predictor, xyz);
    if (status == 0) status = elrom_predict(predictor, inputs, values, 1);
  }
  if (status == 0) {
    printf("%s: %s\n", name, reason);
    print_profile(predictor, xyz, values);
    if (file != NULL) status = elrom_write_prediction(predictor, inputs, name, NAN, file, 1);
  }
  free(inputs);
  free(xyz);
  free(values);
  return status;
}

int main(int argc, char** argv) {
  if (argc != 5 && argc != 6) {
    fprintf(stderr, "predict: arguments are: BUNDLE CASES CASE FIELD [FILE.hdf]\n");
    return 2;
  }
  elrom_predictor* predictor = elrom_open(argv[1], argv[4]);
  if (predictor == NULL) return failed();
  const int status = predict(predictor, argv[2], argv[3], argc == 6 ? argv[5] : NULL);
  elrom_close(predictor);
  return status == 0 ? 0 : failed();
}
