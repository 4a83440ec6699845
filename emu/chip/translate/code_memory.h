#pragma once
// Memory for machine code made at run time: the same pages mapped twice, once to write and once to execute,
// so that no page is ever both. Code in it is position independent. One for the whole process.

#include <cstddef>
#include <cstdint>

namespace puckloop::chip {

class CodeMemory {
  public:
    /// Address space reserved; pages are taken from the host as they are filled.
    static constexpr std::size_t kBytes = std::size_t{64} << 20;

    /// Tries to map it; available() is whether the host allows executable memory.
    CodeMemory();
    ~CodeMemory();
    CodeMemory(const CodeMemory&) = delete;
    CodeMemory& operator=(const CodeMemory&) = delete;

    bool available() const { return writable_ != nullptr; }
    std::uint8_t* writable() const { return writable_; }
    const std::uint8_t* executable() const { return executable_; }

  private:
    std::uint8_t* writable_ = nullptr;
    std::uint8_t* executable_ = nullptr;
};

}  // namespace puckloop::chip
