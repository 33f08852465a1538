/* The C interface as a caller without CMake builds it: cc call.c $(pkg-config --cflags --libs elrom). */
#include <elrom/model/elrom.h>
#include <stdio.h>

int main(void) {
  elrom_predictor* none = elrom_open("no such file", NULL);
  printf("%s: %s\n", elrom_version(), elrom_last_error());
  return none == NULL ? 0 : 1;
}
