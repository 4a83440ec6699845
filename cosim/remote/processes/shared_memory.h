#pragma once
// Memory that several processes map: anonymous, of a fixed size, on no file system.

#include <cstddef>

namespace puckloop::cosim {

class SharedMemory {
  public:
    /// Makes `size` bytes of zeros. Its size is sealed: no process can cut it under another's feet. `name`
    /// shows in /proc/PID/maps. Throws RunError.
    SharedMemory(const char* name, std::size_t size);
    /// Maps what `descriptor` is, which is taken over and closed. Throws RunError if that is no memory of at
    /// least `size` bytes. Processes that this one starts do not get the mapping.
    SharedMemory(int descriptor, std::size_t size);
    ~SharedMemory();
    SharedMemory(const SharedMemory&) = delete;
    SharedMemory& operator=(const SharedMemory&) = delete;

    std::byte* data() const { return data_; }
    /// For a process that is to map it too; -1 once it was closed.
    int descriptor() const { return descriptor_; }
    void close_descriptor();

  private:
    void map(std::size_t size);

    int descriptor_ = -1;
    std::byte* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace puckloop::cosim
