#include "emu/dspic/machine/program_pages.h"

#include "emu/dspic/devices/device.h"
#include "emu/dspic/machine/machine.h"

#include <algorithm>
#include <fcntl.h>
#include <map>
#include <mutex>
#include <new>
#include <sys/mman.h>
#include <unistd.h>

namespace puckloop::dspic {

namespace {

std::size_t page() {
    static const auto size = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    return size;
}

std::size_t word_bytes() {
    return ProgramPages::piece_words() * sizeof(std::uint32_t);
}
std::size_t operation_bytes() {
    return ProgramPages::piece_words() * sizeof(Op);
}

std::byte* mapped(void* at, std::size_t bytes, int flags, int descriptor, std::size_t offset) {
    void* memory = ::mmap(at, bytes, PROT_READ | PROT_WRITE, flags, descriptor, static_cast<off_t>(offset));
    if (memory == MAP_FAILED) throw std::bad_alloc();
    return static_cast<std::byte*>(memory);
}

/// Address space for `count` pieces of `bytes` each.
std::byte* reserved(std::size_t count, std::size_t bytes) {
    return mapped(nullptr, count * bytes, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
}

}  // namespace

std::size_t ProgramPages::piece_words() {
    constexpr std::size_t kFewest = 4096;
    return std::max(kFewest, page() / sizeof(std::uint32_t));  // whole pages of words and of operations
}

/// Pieces in one file in memory: the operations of each, then its words.
class ProgramPages::Pool {
  public:
    static Pool& of_process() {
        static Pool& pool = *new Pool;  // chips may outlive whatever ends with the program
        return pool;
    }
    /// The piece with these words, made if there is none.
    std::shared_ptr<const Piece> piece(std::vector<std::uint32_t> words);
    /// Its operations and words, in place of what is mapped there; writing copies pages.
    void map(const Piece& piece, Op* operations, std::uint32_t* words) const;
    void release(std::size_t place);
    std::size_t in_use();

  private:
    Pool() : descriptor_(::memfd_create("dspic program", MFD_CLOEXEC)) {
        if (descriptor_ < 0) throw std::bad_alloc();
    }
    void fill(std::size_t place, const std::vector<std::uint32_t>& words) const;
    static std::size_t piece_bytes() { return operation_bytes() + word_bytes(); }

    int descriptor_;
    std::recursive_mutex mutex_;  // the last owner of a piece may let go while one is looked for
    std::map<std::vector<std::uint32_t>, std::weak_ptr<const Piece>> pieces_;
    std::vector<std::size_t> free_;
    std::size_t places_ = 0;
};

class ProgramPages::Piece {
  public:
    Piece(std::size_t at, Pool& owner) : place(at), pool_(owner) {}
    ~Piece() { pool_.release(place); }
    Piece(const Piece&) = delete;
    Piece& operator=(const Piece&) = delete;

    const std::size_t place;

  private:
    Pool& pool_;
};

std::shared_ptr<const ProgramPages::Piece> ProgramPages::Pool::piece(std::vector<std::uint32_t> words) {
    const std::lock_guard lock(mutex_);
    if (const auto known = pieces_.find(words); known != pieces_.end())
        if (auto there = known->second.lock()) return there;
    std::erase_if(pieces_, [](const auto& entry) { return entry.second.expired(); });
    if (free_.empty()) {
        if (::ftruncate(descriptor_, static_cast<off_t>((places_ + 1) * piece_bytes())) != 0)
            throw std::bad_alloc();
        free_.push_back(places_++);
    }
    const std::size_t place = free_.back();
    fill(place, words);
    free_.pop_back();
    auto made = std::make_shared<const Piece>(place, *this);
    pieces_.emplace(std::move(words), made);
    return made;
}

void ProgramPages::Pool::fill(std::size_t place, const std::vector<std::uint32_t>& words) const {
    std::byte* const memory = mapped(nullptr, piece_bytes(), MAP_SHARED, descriptor_, place * piece_bytes());
    auto* const operations = reinterpret_cast<Op*>(memory);
    for (std::size_t i = 0; i < words.size(); ++i)
        new (operations + i) Op(blank_operation(words[i]));
    std::copy(words.begin(), words.end(), reinterpret_cast<std::uint32_t*>(memory + operation_bytes()));
    ::munmap(memory, piece_bytes());
}

void ProgramPages::Pool::map(const Piece& piece, Op* operations, std::uint32_t* words) const {
    constexpr int kFlags = MAP_PRIVATE | MAP_FIXED | MAP_NORESERVE;
    const std::size_t at = piece.place * piece_bytes();
    mapped(operations, operation_bytes(), kFlags, descriptor_, at);
    mapped(words, word_bytes(), kFlags, descriptor_, at + operation_bytes());
}

void ProgramPages::Pool::release(std::size_t place) {
    const std::lock_guard lock(mutex_);
    ::fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE,
                static_cast<off_t>(place * piece_bytes()), static_cast<off_t>(piece_bytes()));
    free_.push_back(place);
}

std::size_t ProgramPages::Pool::in_use() {
    const std::lock_guard lock(mutex_);
    return places_ - free_.size();
}

std::size_t ProgramPages::pieces_in_use() {
    return Pool::of_process().in_use();
}

ProgramPages::ProgramPages(std::uint32_t words, std::uint32_t guards)
    : word_count_(words + guards + 1),
      pieces_((word_count_ + piece_words() - 1) / piece_words()),
      mapped_(pieces_) {
    operations_ = reinterpret_cast<Op*>(reserved(pieces_, operation_bytes()));
    words_ = reinterpret_cast<std::uint32_t*>(reserved(pieces_, word_bytes()));
    Pool& pool = Pool::of_process();
    const auto erased = pool.piece(std::vector(piece_words(), kErasedWord));
    for (std::size_t i = 0; i < pieces_; ++i) {
        pool.map(*erased, operations_ + i * piece_words(), words_ + i * piece_words());
        mapped_[i] = erased;
    }
}

ProgramPages::~ProgramPages() {
    ::munmap(operations_, pieces_ * operation_bytes());
    ::munmap(words_, pieces_ * word_bytes());
}

void ProgramPages::share() {
    Pool& pool = Pool::of_process();
    for (std::size_t i = 0; i < pieces_; ++i) {
        std::uint32_t* const words = words_ + i * piece_words();
        const auto piece = pool.piece({words, words + piece_words()});
        pool.map(*piece, operations_ + i * piece_words(), words);
        mapped_[i] = piece;
    }
}

}  // namespace puckloop::dspic
