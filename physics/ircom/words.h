#pragma once
// The IRcom words that were sent, by the light itself: the ground truth beside which receivers are held.
//
// File (CSV), one row per word and device that its light reached, or one with an empty receiver, in the order
// in which words ended: t_s and end_s first and last edge; sender; word (hexadecimal, empty if it cannot be
// read); fault (protocols/infrared/ircom.h) or "none"; receiver; counts: the brightest that the word was
// there; overlap: 1 if another's word that reached the receiver fell into the same time; receiver_sending: 1
// if the receiver itself sent then. Light of fewer than twenty edges is no word: a robot measures proximity.

#include "physics/ircom/medium.h"
#include "physics/world/recorder.h"
#include "protocols/infrared/ircom.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::physics {

class IrcomWords {
  public:
    /// `file` may be empty: then only counts are kept. Throws RunError as CsvFile does.
    IrcomWords(const IrcomMedium& medium, const std::string& file);

    /// The device's light went on or off (its lines together).
    void edge(cosim::Time now, std::size_t device, bool lit);
    /// More of its lines are lit.
    void seen(std::size_t device);
    /// Writes the words that have ended by now.
    void close_until(cosim::Time now);
    /// Ends all words; the report: a JSON array, one object per device.
    std::string finish();

    template <class Archive>
    void state(Archive& archive) {
        archive(senders_);
    }
    // Rows are kept back while a mark is set, as CsvFile does.
    void mark() {
        if (csv_) csv_->mark();
    }
    void rewind() {
        if (csv_) csv_->rewind();
    }
    void settle() {
        if (csv_) csv_->settle();
    }

  private:
    struct Sender {
        protocols::IrcomReader reader;
        cosim::Time last = -1;           ///< newest edge of the word under way, or -1
        int edges = 0;                   ///< of it
        std::vector<double> brightest;   ///< at each device
        std::vector<std::uint8_t> with;  ///< by device: it sent at the same time
        std::uint64_t words = 0, faulty = 0, flashes = 0;

        template <class Archive>
        void state(Archive& archive) {
            archive(reader, last, edges, brightest, with, words, faulty, flashes);
        }
    };

    void close(std::size_t device, const protocols::IrcomReading& reading);
    void write(std::size_t device, const protocols::IrcomReading& reading);

    const IrcomMedium& medium_;
    std::vector<Sender> senders_;
    std::unique_ptr<CsvFile> csv_;
};

}  // namespace puckloop::physics
