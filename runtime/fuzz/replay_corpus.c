/* Runs the fuzz target on files, without a fuzzer: any compiler will do.
 *
 *     replay_corpus FILE ... */
#include "fuzz_step.c"

int main(int argc, char **argv) {
  static unsigned char data[1 << 20];
  for (int i = 1; i < argc; i++) {
    FILE *file = fopen(argv[i], "rb");
    if (!file) return 2;
    const size_t size = fread(data, 1, sizeof data, file);
    fclose(file);
    LLVMFuzzerTestOneInput(data, size);
  }
  printf("%d inputs\n", argc - 1);
  return 0;
}
