// Tests run with the instruction set that CAIRN_INSTRUCTION_SET names, or the best one.
#include <gtest/gtest.h>

#include "core/instruction_set.h"

int main(int count, char** arguments) {
  testing::InitGoogleTest(&count, arguments);
  cairn::obey_environment();
  return RUN_ALL_TESTS();
}
