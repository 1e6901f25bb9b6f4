/* The generated header, read by a C compiler. */
#include "docs/plc/flatpose_registers.h"

int flatpose_registers_in_c(int which) {
  const int values[] = {FLATPOSE_REG_COMMAND_NUMBER, FLATPOSE_REG_DONE_NUMBER,
                        FLATPOSE_STATUS_NO_MATCH, FLATPOSE_BIT_VALID, FLATPOSE_WRITABLE_END};
  return values[which];
}
