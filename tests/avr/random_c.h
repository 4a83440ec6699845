#pragma once
// Random C programs for the AVR's compiler, without undefined behaviour: integers of every width and
// signedness, divisions, shifts, loops, switches, recursion, arrays, structs, function pointers, 64-bit
// arithmetic and floating point. Each writes a checksum after every step as text, so that the first
// difference shows.

#include "base/random.h"

#include <string>
#include <vector>

namespace puckloop::avr::test {

class RandomC {
  public:
    explicit RandomC(RandomStream& random) : random_(random) {}
    std::string program();

  private:
    struct Variable {
        std::string name;
        int type = 0;
    };
    int below(int n) { return static_cast<int>(random_.below(static_cast<std::uint64_t>(n))); }
    std::string literal(int type);
    std::string variable(int type);
    std::string expression(int type, int depth);
    std::string real(int depth);
    std::string condition(int depth);
    std::string assignment();
    std::string statement(int depth);
    std::string block(int depth, int statements);
    std::string function(int number);

    RandomStream& random_;
    std::vector<Variable> variables_;
    int functions_ = 0;  ///< that may be called from here
    int loops_ = 0;
};

}  // namespace puckloop::avr::test
