/* Counts every use of the heap in the process, also by libraries: these functions stand in front of the C
 * library's own. For the one source file of a program that has `main`.
 *
 * Sanitizers stand in the same place: with them nothing is counted. */
#ifndef PROXGEN_COUNT_HEAP_H
#define PROXGEN_COUNT_HEAP_H

#include <stddef.h>

static unsigned long long heap_allocations, heap_frees;

/* What was taken and what was given back. */
static inline unsigned long long heap_calls(void) {
  return heap_allocations + heap_frees;
}

#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define HEAP_IS_COUNTED 0
#endif
#endif
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HEAP_IS_COUNTED 0
#endif

#ifndef HEAP_IS_COUNTED
#define HEAP_IS_COUNTED 1

/* Visible to other libraries, although everything is compiled with hidden symbols. */
#pragma GCC visibility push(default)
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *block, size_t size);
extern void *__libc_memalign(size_t alignment, size_t size);
extern void __libc_free(void *block);

void *malloc(size_t size) {
  heap_allocations++;
  return __libc_malloc(size);
}

void *calloc(size_t count, size_t size) {
  heap_allocations++;
  return __libc_calloc(count, size);
}

void *realloc(void *block, size_t size) {
  heap_allocations++;
  return __libc_realloc(block, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
  heap_allocations++;
  return __libc_memalign(alignment, size);
}

void free(void *block) {
  heap_frees++;
  __libc_free(block);
}
#pragma GCC visibility pop
#endif

#endif
