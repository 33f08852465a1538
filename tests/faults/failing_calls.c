/* Preloaded into a program under test, so that calls fail as on a full or broken disk, or when memory runs out.
 *
 * ELROM_FAIL_AT=n: the n-th call that changes a regular file fails, and so do all later ones; counts from 1.
 * ELROM_FAIL_WITH=errno of these failures (default ENOSPC).
 * ELROM_SHORT_AT=n: the n-th write to a regular file writes half of what it should, which is no error.
 * ELROM_FAIL_ALLOCATION=n: the n-th allocation after the start of main() fails, that one alone.
 * The first of these failures is told on standard error, so that a campaign knows when there are no more calls. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

static void tell(void) {
  static int told;
  if (!__atomic_exchange_n(&told, 1, __ATOMIC_SEQ_CST)) syscall(SYS_write, 2, "[call failed]\n", 14);
}

static int fails_now(void) {
  static int count, at = -1;
  if (at < 0) {
    const char* text = getenv("ELROM_FAIL_AT");
    at = text ? atoi(text) : 0;
  }
  if (at <= 0 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) < at) return 0;
  tell();
  const char* with = getenv("ELROM_FAIL_WITH");
  errno = with ? atoi(with) : ENOSPC;
  return 1;
}

/* Half of a write of n bytes when it is this call's turn to be short, else n. */
static size_t shortened(size_t n) {
  static int count, at = -1;
  if (at < 0) {
    const char* text = getenv("ELROM_SHORT_AT");
    at = text ? atoi(text) : 0;
  }
  if (at <= 0 || n < 2 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) != at) return n;
  tell();
  return n / 2;
}

static int is_file(int descriptor) {
  struct stat status;
  return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

ssize_t write(int d, const void* bytes, size_t n) {
  return is_file(d) && fails_now() ? -1 : REAL(write)(d, bytes, is_file(d) ? shortened(n) : n);
}
ssize_t writev(int d, const struct iovec* parts, int n) {
  return is_file(d) && fails_now() ? -1 : REAL(writev)(d, parts, n);
}
ssize_t pwrite(int d, const void* bytes, size_t n, off_t at) {
  return is_file(d) && fails_now() ? -1 : REAL(pwrite)(d, bytes, is_file(d) ? shortened(n) : n, at);
}
ssize_t pwrite64(int d, const void* bytes, size_t n, off64_t at) {
  return is_file(d) && fails_now() ? -1 : REAL(pwrite64)(d, bytes, is_file(d) ? shortened(n) : n, at);
}
int ftruncate(int d, off_t size) { return is_file(d) && fails_now() ? -1 : REAL(ftruncate)(d, size); }
int ftruncate64(int d, off64_t size) { return is_file(d) && fails_now() ? -1 : REAL(ftruncate64)(d, size); }
int fsync(int d) { return is_file(d) && fails_now() ? -1 : REAL(fsync)(d); }
int rename(const char* from, const char* to) { return fails_now() ? -1 : REAL(rename)(from, to); }

/* Allocations: armed when main() begins, because nobody promises anything about what runs before it. */
static int armed;

static int memory_is_out(void) {
  static int count, at = -1;
  if (!armed) return 0;
  if (at < 0) {
    const char* text = getenv("ELROM_FAIL_ALLOCATION");
    at = text ? atoi(text) : 0;
  }
  if (at <= 0 || __atomic_add_fetch(&count, 1, __ATOMIC_SEQ_CST) != at) return 0;
  tell();
  errno = ENOMEM;
  return 1;
}

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

void* malloc(size_t n) { return memory_is_out() ? NULL : __libc_malloc(n); }
void* calloc(size_t n, size_t size) { return memory_is_out() ? NULL : __libc_calloc(n, size); }
void* realloc(void* old, size_t n) { return memory_is_out() ? NULL : __libc_realloc(old, n); }
void* aligned_alloc(size_t alignment, size_t n) { return memory_is_out() ? NULL : __libc_memalign(alignment, n); }
int posix_memalign(void** block, size_t alignment, size_t n) {
  void* memory = memory_is_out() ? NULL : __libc_memalign(alignment, n);
  if (memory == NULL) return ENOMEM;
  *block = memory;
  return 0;
}

typedef int (*main_function)(int, char**, char**);
static main_function real_main;
static int armed_main(int n, char** arguments, char** environment) {
  armed = 1;
  return real_main(n, arguments, environment);
}
int __libc_start_main(main_function begin, int n, char** arguments, void (*init)(void), void (*fini)(void),
                      void (*unload)(void), void* stack) {
  int (*start)(main_function, int, char**, void (*)(void), void (*)(void), void (*)(void), void*) =
      (__typeof__(start))dlsym(RTLD_NEXT, "__libc_start_main");
  real_main = begin;
  return start(armed_main, n, arguments, init, fini, unload, stack);
}
