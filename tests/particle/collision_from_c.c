/* Three collisions by the C interface; prints what it gives, one pair a line: linear_1, linear_2, angular_1,
 * angular_2. Arguments: model. */
#include <elrom/particle/collision.h>
#include <stdio.h>

enum { n = 3 };
static const double velocity_1[] = {1, 0.5, -0.25, 2, 0, 0, -1, 0, 0};
static const double velocity_2[] = {-1, 0, 0, 0, 1, 0, 1, 0, 0}; /* the last pair parts */
static const double spin_1[] = {0, 0, 500, -300, 0, 0, 0, 0, 0};
static const double normal[] = {1, 0, 0, 0.6, -0.8, 0, 1, 0, 0};
static const double diameter_1[] = {315e-6, 315e-6, 315e-6}, diameter_2[] = {475e-6, 315e-6, 475e-6};
static const double density_1[] = {1000, 1200, 1000}, density_2[] = {1000, 1000, 1000};

static void print_row(const double* values, size_t i) {
  for (size_t axis = 0; axis < 3; ++axis) printf("%.17g ", values[3 * i + axis]);
}

int main(int argc, char** argv) {
  double linear_1[3 * n], linear_2[3 * n], angular_1[3 * n], angular_2[3 * n];
  elrom_collision* model = argc == 2 ? elrom_collision_open(argv[1]) : NULL;
  int status = 3;
  if (model != NULL)
    status =
        elrom_collision_impulses(model, n, velocity_1, velocity_2, spin_1, NULL, normal, diameter_1,
                                 diameter_2, density_1, density_2, linear_1, linear_2, angular_1, angular_2);
  if (status != 0) {
    fprintf(stderr, "%s\n", elrom_collision_last_error());
    return status;
  }
  for (size_t i = 0; i < n; ++i) {
    print_row(linear_1, i);
    print_row(linear_2, i);
    print_row(angular_1, i);
    print_row(angular_2, i);
    printf("\n");
  }
  elrom_collision_close(model);
  return 0;
}
