#pragma once
// What changes of the program while a mark is set (Core::mark()): flash, EEPROM and configuration words, and
// the operations decoded from them. Nothing of it is copied at a mark: each change is noted, and taken back
// in reverse order.

#include <cstdint>
#include <vector>

namespace puckloop::dspic {

struct Machine;

class ProgramUndo {
  public:
    bool on() const { return on_; }
    /// Notes from here on; forgets earlier notes.
    void begin() {
        end();
        on_ = true;
    }
    void end() {
        on_ = false;
        words_.clear();
        operations_.clear();
    }
    /// Takes back everything noted, without a word to the loops; notes go on.
    void rewind(Machine& m);

    /// Before the word at a program address is written another value.
    void note_word(std::uint32_t address, std::uint32_t word) { words_.push_back({address, word}); }
    /// Before an operation is decoded, thrown away or marked.
    void note_operation(const Machine& m, std::uint32_t index);

  private:
    struct Word {
        std::uint32_t address = 0;
        std::uint32_t word = 0;
    };
    struct Operation {
        std::uint32_t index = 0;
        std::uint8_t marks = 0;
        bool decoded = false;
        bool may_skip = false;
    };
    bool on_ = false;
    std::vector<Word> words_;
    std::vector<Operation> operations_;
};

}  // namespace puckloop::dspic
