#include "cosim/core/octets.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <mutex>
#include <new>

namespace puckloop::cosim {

namespace {

constexpr std::size_t kOctetChunk = 4UL << 20;
constexpr std::size_t kOctetChunksInMemory = 4;

/// Where strings are made one behind the other. They never move: what goes to the file keeps its place in the
/// address space.
class OctetStore {
  public:
    void* room_for(std::size_t size) {
        size = (size + alignof(std::uint64_t) - 1) / alignof(std::uint64_t) * alignof(std::uint64_t);
        if (chunks_.empty() || used_ + size > kOctetChunk) add_chunk();
        void* room = chunks_.back() + used_;
        used_ += size;
        return room;
    }

  private:
    void add_chunk() {
        void* chunk =
            ::mmap(nullptr, kOctetChunk, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (chunk == MAP_FAILED) throw std::bad_alloc();
        chunks_.push_back(static_cast<std::uint8_t*>(chunk));
        used_ = 0;
        if (chunks_.size() <= kOctetChunksInMemory) return;
        move_to_file(chunks_.front());
        chunks_.pop_front();
    }

    /// The same octets at the same place, mapped from the file.
    void move_to_file(std::uint8_t* chunk) {
        open_file();
        if (file_ < 0) return;
        for (std::size_t written = 0; written < kOctetChunk;) {
            const ssize_t one =
                ::pwrite(file_, chunk + written, kOctetChunk - written, end_ + static_cast<off_t>(written));
            if (one <= 0) return;  // no room on the disk
            written += static_cast<std::size_t>(one);
        }
        if (::mmap(chunk, kOctetChunk, PROT_READ, MAP_SHARED | MAP_FIXED, file_, end_) == MAP_FAILED) return;
        end_ += static_cast<off_t>(kOctetChunk);
    }

    /// A process that another one has made by fork() has a file of its own.
    void open_file() {
        if (owner_ == ::getpid()) return;
        owner_ = ::getpid();
        file_ = -1;  // the other one's: its descriptor stays, as the mappings do
        end_ = 0;
        const char* const set = std::getenv("TMPDIR");
        for (const char* folder : {set, "/var/tmp", "/tmp"}) {
            if (folder == nullptr || *folder == '\0') continue;
            file_ = ::open(folder, O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
            if (file_ >= 0) return;
        }
    }

    std::deque<std::uint8_t*> chunks_;  ///< in memory, the newest last
    std::size_t used_ = 0;              ///< of the newest
    pid_t owner_ = -1;
    int file_ = -1;
    off_t end_ = 0;
};

}  // namespace

Octets::Octets(std::span<const std::uint8_t> octets) {
    if (octets.empty()) return;
    static std::mutex mutex;
    static OctetStore store;
    const std::size_t size = std::min(octets.size(), kMostOctets);
    const std::lock_guard lock(mutex);
    Kept* kept = ::new (store.room_for(sizeof(Kept) + size)) Kept{static_cast<std::uint32_t>(size)};
    std::memcpy(kept + 1, octets.data(), size);
    kept_ = kept;
}

bool operator==(const Octets& a, const Octets& b) {
    return a.kept_ == b.kept_ || std::ranges::equal(a.view(), b.view());
}

}  // namespace puckloop::cosim
