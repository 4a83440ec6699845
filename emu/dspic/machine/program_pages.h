#pragma once
// The flash words of a chip and the operations decoded from them, some megabytes of which a program uses
// little. Chips of one process share what is the same: a piece of memory with the same words is there once,
// until a chip writes to it or decodes from it, and then only pages of it are that chip's own.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace puckloop::dspic {

struct Op;

class ProgramPages {
  public:
    /// Every word erased, with `guards` more operations behind those of the words, and a word more than
    /// operations. Throws std::bad_alloc.
    ProgramPages(std::uint32_t words, std::uint32_t guards);
    ~ProgramPages();
    ProgramPages(const ProgramPages&) = delete;
    ProgramPages& operator=(const ProgramPages&) = delete;

    /// Both stay where they are for good.
    std::span<std::uint32_t> words() const { return {words_, word_count_}; }
    Op* operations() const { return operations_; }

    /// After many words were written: every operation is to be decoded again, and pieces with the same words
    /// are shared.
    void share();

    /// Words of a piece on this machine.
    static std::size_t piece_words();
    /// Pieces that the process has, shared or not.
    static std::size_t pieces_in_use();

  private:
    class Piece;
    class Pool;

    std::size_t word_count_;
    std::size_t pieces_;
    Op* operations_ = nullptr;
    std::uint32_t* words_ = nullptr;
    std::vector<std::shared_ptr<const Piece>> mapped_;
};

}  // namespace puckloop::dspic
