#pragma once
// What went over one direction of a link, kept for a snapshot of the run (cosim/resume/run_snapshot.h).

#include "cosim/core/codec.h"
#include "cosim/core/message.h"
#include "cosim/trace/trace.h"

#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::cosim {

/// Messages in the order in which they were sent, as they would have been delivered without any fault.
class SentRecord {
  public:
    /// `keep`: the messages themselves, not their digest alone.
    explicit SentRecord(bool keep) : keep_(keep) {}
    SentRecord() = default;

    void add(Time delivery, const Payload& payload);

    std::uint64_t count() const { return count_; }
    /// Of all messages added, in their order: 64-bit FNV-1a over their encoding.
    std::uint64_t digest() const { return digest_; }
    bool keeps() const { return keep_; }
    /// How long a record is: what it takes to have it again from a longer one.
    struct Length {
        std::uint64_t count = 0;
        std::uint64_t digest = 0;
        std::size_t bytes = 0;
    };
    Length length() const { return {count_, digest_, keep_ ? bytes_.size() : 0}; }
    /// This record as it was when length() was that.
    SentRecord beginning(const Length& length) const;
    /// Each with the time of its delivery and the port `to`. Throws CodecError if the bytes are damaged.
    std::vector<Message> messages(PortIndex to) const;

    template <class Archive>
    void state(Archive& archive) {
        archive(keep_, count_, digest_, bytes_);
    }

  private:
    static constexpr std::uint64_t kOffset = 0xcbf29ce484222325, kPrime = 0x100000001b3;

    bool keep_ = false;
    std::uint64_t count_ = 0;
    std::uint64_t digest_ = kOffset;
    Bytes bytes_;  ///< of kept messages; of others the last one
};

/// One direction of a link at an instant, with what it needs to be brought there again.
struct WireState {
    std::uint64_t sequence = 0;      ///< messages delivered
    std::uint64_t brought_back = 0;  ///< to their sender
    bool faulty = false;             ///< the link had faults
    SentRecord sent;
    std::vector<TraceRecord> arrived{};  ///< of a link with faults: all that was delivered
};

}  // namespace puckloop::cosim
