/* Preloaded into a program under test: the n-th call that changes a regular file fails, and so do all later ones, as on
 * a full or broken disk. ELROM_FAIL_AT=n counts from 1; ELROM_FAIL_WITH=errno (default ENOSPC). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static int fails_now(void) {
  static int count, at = -1;
  if (at < 0) {
    const char* text = getenv("ELROM_FAIL_AT");
    at = text ? atoi(text) : 0;
  }
  if (at <= 0 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) < at) return 0;
  const char* with = getenv("ELROM_FAIL_WITH");
  errno = with ? atoi(with) : ENOSPC;
  return 1;
}

static int is_file(int descriptor) {
  struct stat status;
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int d, const void* bytes, size_t n) {
  return is_file(d) && fails_now() ? -1 : REAL(write)(d, bytes, n);
}
ssize_t writev(int d, const struct iovec* parts, int n) {
  return is_file(d) && fails_now() ? -1 : REAL(writev)(d, parts, n);
}
ssize_t pwrite(int d, const void* bytes, size_t n, off_t at) {
  return is_file(d) && fails_now() ? -1 : REAL(pwrite)(d, bytes, n, at);
}
ssize_t pwrite64(int d, const void* bytes, size_t n, off64_t at) {
  return is_file(d) && fails_now() ? -1 : REAL(pwrite64)(d, bytes, n, at);
}
int ftruncate(int d, off_t size) { return is_file(d) && fails_now() ? -1 : REAL(ftruncate)(d, size); }
int ftruncate64(int d, off64_t size) { return is_file(d) && fails_now() ? -1 : REAL(ftruncate64)(d, size); }
int fsync(int d) { return is_file(d) && fails_now() ? -1 : REAL(fsync)(d); }
int rename(const char* from, const char* to) { return fails_now() ? -1 : REAL(rename)(from, to); }
