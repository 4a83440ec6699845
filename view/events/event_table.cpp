#include "view/events/event_table.h"

#include "base/error.h"
#include "view/recording/bytes.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <limits>

namespace puckloop::view {

namespace {

constexpr std::size_t kBuffer = 1 << 18;

[[noreturn]] void fail(const char* what) {
    throw RunError(std::string("the file of event texts (a temporary one) ") + what + ": " +
                   std::strerror(errno != 0 ? errno : EIO));
}

char lower(char c) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

/// Whether `text` has `part`, which is in lower case.
bool has(std::string_view text, std::string_view part) {
    return std::search(text.begin(), text.end(), part.begin(), part.end(),
                       [](char a, char b) { return lower(a) == b; }) != text.end();
}

}  // namespace

EventTable::EventTable(std::size_t most, std::uint32_t generation)
    : most_(std::max<std::size_t>(most, 2)), texts_(std::tmpfile()), generation_(generation) {
    if (!texts_) fail("cannot be made");
}

std::uint16_t EventTable::track(const Track& track) {
    const std::lock_guard lock(mutex_);
    if (const auto found = by_name_.find(track.name); found != by_name_.end()) return found->second;
    if (names_.size() >= std::numeric_limits<std::uint16_t>::max())
        throw RunError("a recording with more than 65,535 tracks cannot be shown");
    const auto number = static_cast<std::uint16_t>(names_.size());
    names_.push_back(track);
    seen_.push_back(0);
    by_name_[track.name] = number;
    return number;
}

void EventTable::add(std::uint16_t track, double begin, double duration, std::uint8_t flags,
                     std::string_view text) {
    const std::lock_guard lock(mutex_);
    if (flags == 0) {
        if (seen_[track]++ % stride_ != 0) {
            ++left_out_;
            return;
        }
        if (++plain_ > most_) thin();
    }
    text = text.substr(0, kLongestText);
    begins_.push_back(begin);
    durations_.push_back(static_cast<float>(duration));
    tracks_.push_back(track);
    flags_.push_back(flags);
    text_at_.push_back(written_ + pending_.size());
    text_size_.push_back(static_cast<std::uint16_t>(text.size()));
    pending_ += text;
    if (pending_.size() < kBuffer) return;
    errno = 0;
    if (std::fseek(texts_.get(), 0, SEEK_END) != 0 ||
        std::fwrite(pending_.data(), 1, pending_.size(), texts_.get()) != pending_.size() ||
        std::fflush(texts_.get()) != 0)
        fail("cannot be written");
    written_ += pending_.size();
    pending_.clear();
}

void EventTable::thin() {
    std::vector<std::uint64_t> kept(names_.size(), 0);
    std::size_t to = 0;
    plain_ = 0;
    for (std::size_t from = 0; from < begins_.size(); ++from) {
        if (flags_[from] == 0) {
            if (kept[tracks_[from]]++ % 2 != 0) {
                ++left_out_;
                continue;
            }
            ++plain_;
        }
        begins_[to] = begins_[from];
        durations_[to] = durations_[from];
        tracks_[to] = tracks_[from];
        flags_[to] = flags_[from];
        text_at_[to] = text_at_[from];
        text_size_[to] = text_size_[from];
        ++to;
    }
    begins_.resize(to);
    durations_.resize(to);
    tracks_.resize(to);
    flags_.resize(to);
    text_at_.resize(to);
    text_size_.resize(to);
    stride_ *= 2;
    ++generation_;
}

EventTable::Kept EventTable::keep() const {
    const std::lock_guard lock(mutex_);
    Kept kept{begins_, durations_, tracks_, flags_, text_size_, names_, left_out_};
    for (const std::uint16_t size : text_size_)
        kept.text_bytes += size;
    return kept;
}

void EventTable::each_text(const std::function<void(std::string_view)>& take) const {
    const std::lock_guard lock(mutex_);
    std::string piece;
    std::uint64_t piece_at = 0;
    for (std::size_t i = 0; i < text_at_.size(); ++i)
        take(text_of(i, piece, piece_at));
}

bool EventTable::take(Kept kept, std::FILE* texts) {
    const auto of_no_track = [&](std::uint16_t track) { return track >= kept.names.size(); };
    if (std::any_of(kept.tracks.begin(), kept.tracks.end(), of_no_track)) return false;
    std::vector<std::uint64_t> places;
    places.reserve(kept.text_sizes.size());
    std::uint64_t at = kept.texts_at;
    for (const std::uint16_t size : kept.text_sizes) {
        places.push_back(at);
        at += size;
    }
    if (at != kept.texts_at + kept.text_bytes) return false;
    const std::lock_guard lock(mutex_);
    begins_ = std::move(kept.begins);
    durations_ = std::move(kept.durations);
    tracks_ = std::move(kept.tracks);
    flags_ = std::move(kept.flags);
    text_size_ = std::move(kept.text_sizes);
    text_at_ = std::move(places);
    names_ = std::move(kept.names);
    by_name_.clear();
    for (std::size_t i = 0; i < names_.size(); ++i)
        by_name_[names_[i].name] = static_cast<std::uint16_t>(i);
    seen_.assign(names_.size(), 0);
    left_out_ = static_cast<std::size_t>(kept.left_out);
    texts_.reset(texts);
    written_ = at;
    pending_.clear();
    return true;
}

EventTable::Status EventTable::status() const {
    const std::lock_guard lock(mutex_);
    return {generation_, begins_.size(), left_out_, names_};
}

std::string EventTable::block(std::size_t first, std::size_t most) const {
    const std::lock_guard lock(mutex_);
    first = std::min(first, begins_.size());
    const std::size_t count = std::min(most, begins_.size() - first);
    std::string out;
    out.reserve(16 + count * 15);
    append_number(out, generation_);
    append_number(out, static_cast<std::uint32_t>(first));
    append_number(out, static_cast<std::uint32_t>(count));
    append_number(out, static_cast<std::uint32_t>(begins_.size()));
    append_numbers(out, std::span(begins_).subspan(first, count));
    append_numbers(out, std::span(durations_).subspan(first, count));
    append_numbers(out, std::span(tracks_).subspan(first, count));
    append_numbers(out, std::span(flags_).subspan(first, count));
    return out;
}

std::string EventTable::read(std::uint64_t at, std::size_t count) const {
    std::string text(count, '\0');
    if (at >= written_) return pending_.substr(static_cast<std::size_t>(at - written_), count);
    const auto in_file = static_cast<std::size_t>(std::min<std::uint64_t>(count, written_ - at));
    for (std::size_t done = 0; done < in_file;) {
        const ::ssize_t got = ::pread(::fileno(texts_.get()), text.data() + done, in_file - done,
                                      static_cast<::off_t>(at + done));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) fail("cannot be read");
        done += static_cast<std::size_t>(got);
    }
    if (in_file < count) text.replace(in_file, count - in_file, pending_, 0, count - in_file);
    return text;
}

std::vector<std::string> EventTable::texts(const std::vector<std::size_t>& numbers) const {
    const std::lock_guard lock(mutex_);
    std::vector<std::string> found;
    found.reserve(numbers.size());
    for (const std::size_t number : numbers)
        found.push_back(number < text_at_.size() ? read(text_at_[number], text_size_[number])
                                                 : std::string());
    return found;
}

std::vector<std::uint32_t> EventTable::find(std::string_view part, std::size_t most) const {
    std::string wanted(part);
    std::transform(wanted.begin(), wanted.end(), wanted.begin(), lower);
    const std::lock_guard lock(mutex_);
    std::vector<std::uint32_t> found;
    // Texts follow one another in the file in the order of the events: it is read in large pieces.
    std::string piece;
    std::uint64_t piece_at = 0;
    for (std::size_t i = 0; i < text_at_.size() && found.size() < most; ++i)
        if (has(text_of(i, piece, piece_at), wanted)) found.push_back(static_cast<std::uint32_t>(i));
    return found;
}

std::string_view EventTable::text_of(std::size_t number, std::string& piece, std::uint64_t& piece_at) const {
    const std::uint64_t at = text_at_[number];
    const std::size_t size = text_size_[number];
    if (at < piece_at || at + size > piece_at + piece.size()) {
        piece_at = at;
        piece = read(at, static_cast<std::size_t>(
                             std::min<std::uint64_t>(4 * kBuffer, written_ + pending_.size() - at)));
    }
    return std::string_view(piece).substr(static_cast<std::size_t>(at - piece_at), size);
}

}  // namespace puckloop::view
