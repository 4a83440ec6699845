// The format: a zip archive with `version`, `metadata` (an ini file) and the samples of all channels in
// `logic-1-1`, `logic-1-2`, ...: little-endian words of `unitsize` bytes, bit n = channel n
// (https://sigrok.org/wiki/File_format:Sigrok/v2).

#include "base/error.h"
#include "traces/edges.h"
#include "traces/formats/export.h"

#include <fmt/format.h>
#include <zip.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

namespace puckloop::tools {

namespace {

using cosim::Time;

constexpr std::uint64_t kChunkBytes = 4 << 20;
constexpr std::uint64_t kMostBytes = std::uint64_t{64} << 30;  // before compression
constexpr std::uint64_t kSamplesOfBit = 16;

/// The first sample at or after `time` (>= 0): time * rate / 1 s, rounded up, without overflow.
std::uint64_t sample_at(Time time, std::uint64_t rate) {
    constexpr std::uint64_t kSecond = cosim::kSecond, kMillion = 1'000'000;
    const auto whole = static_cast<std::uint64_t>(time) / kSecond;
    const auto rest = static_cast<std::uint64_t>(time) % kSecond;
    const std::uint64_t high = rest / kMillion * rate;  // in 1e-6 samples
    const std::uint64_t low = high % kMillion * kMillion + rest % kMillion * rate;
    return whole * rate + high / kMillion + (low + kSecond - 1) / kSecond;
}

/// 1, 2 or 5 times a power of ten with enough samples in the shortest bit.
std::uint64_t fitting_rate(Time shortest_bit) {
    constexpr std::uint64_t kMostRate = 1'000'000'000;
    if (shortest_bit == cosim::kNever || shortest_bit <= 0) return 1'000'000;
    const std::uint64_t wanted = sample_at(
        cosim::kSecond,
        kSamplesOfBit * static_cast<std::uint64_t>(cosim::kSecond / std::max<Time>(shortest_bit, 1)));
    for (std::uint64_t decade = 1000; decade < kMostRate; decade *= 10)
        for (const std::uint64_t step : {1, 2, 5})
            if (step * decade >= wanted) return step * decade;
    return kMostRate;
}

/// All samples, one after the other.
class Samples {
  public:
    Samples(const RecordedTrace& trace, const FaultMarks& marks, const LineSurvey& found, std::uint64_t rate,
            Time origin, std::uint64_t count)
        : edges_(trace, marks, found), rate_(rate), origin_(origin), count_(count) {
        for (const Line& line : found.lines) {
            channel_.push_back(line.logic ? static_cast<int>(channels_++) : -1);
            if (!line.logic) continue;
            word_.resize((channels_ + 7) / 8);
            set(channel_.back(), line.rests_high());
        }
        next_ = edges_.next();
    }

    std::size_t unit() const { return word_.size(); }

    /// Fills `out`, whole words only.
    void fill(char* out, std::uint64_t samples) {
        while (samples > 0) {
            while (next_ && change_at() <= now_) {
                for (const auto& [line, level] : next_->levels)
                    if (channel_[line] >= 0) set(channel_[line], level);
                next_ = edges_.next();
            }
            const std::uint64_t until = next_ ? std::min(change_at(), count_) : count_;
            const std::uint64_t same = std::min(samples, std::max(until, now_ + 1) - now_);
            if (unit() == 1) {
                std::memset(out, word_[0], same);
            } else {
                for (std::uint64_t i = 0; i < same; ++i)
                    std::memcpy(out + i * unit(), word_.data(), unit());
            }
            out += same * unit();
            now_ += same;
            samples -= same;
        }
    }

  private:
    std::uint64_t change_at() const {
        return next_->time <= origin_ ? 0 : sample_at(next_->time - origin_, rate_);
    }
    void set(int channel, bool level) {
        unsigned char& byte = word_[static_cast<std::size_t>(channel) / 8];
        const auto bit = static_cast<unsigned char>(1U << (channel % 8));
        byte = static_cast<unsigned char>(level ? byte | bit : byte & ~bit);
    }

    EdgeStream edges_;
    std::uint64_t rate_;
    Time origin_;
    std::uint64_t count_, now_ = 0;
    std::vector<int> channel_;
    std::size_t channels_ = 0;
    std::vector<unsigned char> word_;
    std::optional<Edges> next_;
};

/// One member of the archive, made while it is written.
struct Chunk {
    Samples* samples = nullptr;
    std::exception_ptr* failed = nullptr;
    std::uint64_t bytes = 0, left = 0;
    std::vector<char> rest;  ///< of a word that did not fit into the last buffer

    /// Fills all of `out`, as libzip takes less for the end; words may be cut.
    void read(char* out, std::uint64_t length) {
        const std::uint64_t begun = std::min<std::uint64_t>(rest.size(), length);
        std::copy_n(rest.begin(), begun, out);
        rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(begun));
        const std::size_t unit = samples->unit();
        const std::uint64_t words = (length - begun) / unit;
        samples->fill(out + begun, words);
        const std::uint64_t missing = length - begun - words * unit;
        if (missing == 0) return;
        rest.resize(unit);
        samples->fill(rest.data(), 1);
        std::copy_n(rest.begin(), missing, out + begun + words * unit);
        rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(missing));
    }
};

zip_int64_t chunk_call(void* user, void* data, zip_uint64_t length, zip_source_cmd_t command) {
    auto* chunk = static_cast<Chunk*>(user);
    switch (command) {
    case ZIP_SOURCE_OPEN:
        chunk->left = chunk->bytes;
        return 0;
    case ZIP_SOURCE_READ: {
        const std::uint64_t count = std::min<std::uint64_t>(length, chunk->left);
        try {
            chunk->read(static_cast<char*>(data), count);
        } catch (...) {
            *chunk->failed = std::current_exception();
            return -1;
        }
        chunk->left -= count;
        return static_cast<zip_int64_t>(count);
    }
    case ZIP_SOURCE_STAT: {
        auto* stat = static_cast<zip_stat_t*>(data);
        zip_stat_init(stat);
        stat->size = chunk->bytes;
        stat->mtime = 0;
        stat->valid = ZIP_STAT_SIZE | ZIP_STAT_MTIME;
        return sizeof *stat;
    }
    case ZIP_SOURCE_ERROR:
        return zip_error_to_data(nullptr, data, length) < 0 ? 0 : 2 * sizeof(int);
    case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_CLOSE,
                                              ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR, ZIP_SOURCE_FREE, -1);
    default:
        return 0;
    }
}

class Archive {
  public:
    explicit Archive(const std::string& path) : path_(path) {
        int error = 0;
        zip_ = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &error);
        if (zip_ == nullptr) {
            zip_error_t what;
            zip_error_init_with_code(&what, error);
            const std::string text = zip_error_strerror(&what);
            zip_error_fini(&what);
            throw RunError(fmt::format("{}: cannot write: {}", path_, text));
        }
    }
    ~Archive() {
        if (zip_ != nullptr) zip_discard(zip_);
    }
    Archive(const Archive&) = delete;
    Archive& operator=(const Archive&) = delete;

    /// `text` must live until close().
    void add(const std::string& name, const std::string& text) {
        put(name, zip_source_buffer(zip_, text.data(), text.size(), 0));
    }
    void add(const std::string& name, Chunk& chunk) {
        const zip_int64_t at = put(name, zip_source_function(zip_, chunk_call, &chunk));
        constexpr zip_uint32_t kFastest = 1;
        zip_set_file_compression(zip_, static_cast<zip_uint64_t>(at), ZIP_CM_DEFLATE, kFastest);
    }
    void close(const std::exception_ptr& failed) {
        const bool good = zip_close(zip_) == 0;
        if (failed) std::rethrow_exception(failed);
        if (!good) fail();
        zip_ = nullptr;
    }

  private:
    [[noreturn]] void fail() {
        throw RunError(fmt::format("{}: cannot write: {}", path_, zip_strerror(zip_)));
    }
    zip_int64_t put(const std::string& name, zip_source_t* source) {
        const zip_int64_t at = source == nullptr ? -1 : zip_file_add(zip_, name.c_str(), source, 0);
        if (at < 0) fail();
        // The same trace gives the same file: no time of day in it (1 January 1980, where zip begins).
        zip_file_set_dostime(zip_, static_cast<zip_uint64_t>(at), 0, 0x21, 0);
        return at;
    }

    std::string path_;
    zip_t* zip_ = nullptr;
};

std::string metadata(const LineSurvey& found, std::uint64_t rate) {
    std::string text = fmt::format("[global]\nsigrok version=0.5.2\n\n[device 1]\ncapturefile=logic-1\n");
    std::string probes;
    std::size_t count = 0;
    for (const Line& line : found.lines)
        if (line.logic) probes += fmt::format("probe{}={}\n", ++count, line.full_name());
    return fmt::format("{}total probes={}\nsamplerate={} Hz\ntotal analog=0\n{}unitsize={}\n", text, count,
                       rate, probes, (count + 7) / 8);
}

}  // namespace

void export_sr(const RecordedTrace& trace, const std::string& path, std::uint64_t rate) {
    if (path == "-")
        throw InputError("", "--output", "a sigrok session is a zip archive and needs a file", "-o FILE.sr");
    const FaultMarks marks(trace);
    const LineSurvey found = survey(trace, marks);
    const auto is_logic = [](const Line& line) { return line.logic; };
    if (std::none_of(found.lines.begin(), found.lines.end(), is_logic))
        throw InputError(trace.file().string(), "", "no line to draw is among the rows asked for",
                         "UART, I2C, radio or signals of 0 and 1");
    if (rate == 0) rate = fitting_rate(found.shortest_bit);
    const Time origin = cosim::from_seconds(trace.selection().from_s);
    const std::uint64_t count = sample_at(std::max<Time>(found.last - origin, 0), rate) + kSamplesOfBit;
    Samples samples(trace, marks, found, rate, origin, count);
    if (count > kMostBytes / samples.unit())
        throw InputError("", "--rate",
                         fmt::format("{} samples of {} bytes are too many", count, samples.unit()),
                         "a lower rate, or fewer links or a shorter time by --link, --from and --to");
    const std::uint64_t per_chunk = kChunkBytes / samples.unit();
    std::vector<std::unique_ptr<Chunk>> chunks;
    std::exception_ptr failed;
    const std::string version = "2", about = metadata(found, rate);
    Archive archive(path);
    archive.add("version", version);
    archive.add("metadata", about);
    for (std::uint64_t at = 0; at < count; at += per_chunk) {
        chunks.push_back(std::make_unique<Chunk>());
        chunks.back()->samples = &samples;
        chunks.back()->failed = &failed;
        chunks.back()->bytes = std::min(per_chunk, count - at) * samples.unit();
        archive.add(fmt::format("logic-1-{}", chunks.size()), *chunks.back());
    }
    archive.close(failed);
}

}  // namespace puckloop::tools
