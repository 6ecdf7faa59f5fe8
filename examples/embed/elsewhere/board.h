/* What replay.c asks of the place where it runs: two streams of doubles and a counter of instructions. */
#ifndef BOARD_H
#define BOARD_H

/* Opens inputs.bin for reading and outputs.bin for writing. 0: done, anything else: failed. */
int board_open(void);

/* The next doubles of inputs.bin; 0: done, anything else: failed, also where the file ends. */
int board_read(double *values, int count);

/* Appends to outputs.bin; 0: done, anything else: failed. */
int board_write(const double *values, int count);

/* Closes outputs.bin. 0: everything was written. */
int board_close(void);

/* Instructions executed since the counter was started; 0 where they are not counted. */
void board_start_counting(void);
double board_instructions(void);

/* Deepest stack so far [bytes]; 0 where it is not measured. */
double board_stack(void);

#endif
