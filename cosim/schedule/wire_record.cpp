#include "cosim/schedule/wire_record.h"

namespace puckloop::cosim {

void SentRecord::add(Time delivery, const Payload& payload) {
    if (!keep_) bytes_.clear();
    const std::size_t begin = bytes_.size();
    ByteWriter writer(bytes_);
    writer.time(delivery);
    writer.payload(payload);
    for (std::size_t i = begin; i < bytes_.size(); ++i)
        digest_ = (digest_ ^ bytes_[i]) * kPrime;
    ++count_;
}

SentRecord SentRecord::beginning(const Length& length) const {
    SentRecord record(keep_);
    record.count_ = length.count;
    record.digest_ = length.digest;
    record.bytes_.assign(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(length.bytes));
    return record;
}

std::vector<Message> SentRecord::messages(PortIndex to) const {
    std::vector<Message> messages;
    if (!keep_) return messages;
    ByteReader reader(bytes_);
    while (reader.left() > 0) {
        const Time time = reader.time();
        messages.push_back({time, to, reader.payload()});
    }
    if (messages.size() != count_) throw CodecError("another number of messages");
    return messages;
}

}  // namespace puckloop::cosim
