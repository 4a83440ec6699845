#include "linuxboard/netmanager/manager.h"

#include <boost/asio/read_until.hpp>
#include <boost/asio/streambuf.hpp>
#include <boost/asio/write.hpp>

#include <cstdio>
#include <deque>
#include <stdexcept>

namespace puckloop::netmanager {

using boost::asio::ip::tcp;
using Error = boost::system::error_code;

namespace {
/// What waits for a client that does not read; beyond it messages for it are lost.
constexpr std::size_t kMostWaiting = 256 * 1024;
}  // namespace

/// A connected robot.
class Client : public std::enable_shared_from_this<Client> {
  public:
    Client(Manager& manager, tcp::socket socket, int number)
        : manager_(manager), socket_(std::move(socket)), number_(number) {}

    int number() const { return number_; }

    void read() {
        auto self = shared_from_this();
        boost::asio::async_read_until(socket_, input_, '\r', [self](Error error, std::size_t size) {
            if (self->closed_) return;
            if (error) {
                const bool too_long = error == boost::asio::error::not_found;
                self->manager_.gone(*self, too_long ? "sent a line without an end" : error.message());
                return;
            }
            const char* begin = static_cast<const char*>(self->input_.data().data());
            const std::string line(begin, size - 1);
            self->input_.consume(size);
            self->manager_.receive(*self, line);
            if (!self->closed_) self->read();
        });
    }

    /// False if too much waits for it already.
    bool write(const std::string& line) {
        if (waiting_size_ + line.size() > kMostWaiting) return false;
        waiting_size_ += line.size();
        waiting_.push_back(line);
        if (waiting_.size() == 1) write_first();
        return true;
    }

    void close() {
        Error none;
        closed_ = true;
        socket_.close(none);
    }

  private:
    void write_first() {
        auto self = shared_from_this();
        boost::asio::async_write(socket_, boost::asio::buffer(waiting_.front()),
                                 [self](Error error, std::size_t) {
                                     if (error || self->closed_) return;  // read() hears of it
                                     self->waiting_size_ -= self->waiting_.front().size();
                                     self->waiting_.pop_front();
                                     if (!self->waiting_.empty()) self->write_first();
                                 });
    }

    Manager& manager_;
    tcp::socket socket_;
    int number_;
    boost::asio::streambuf input_{kLongest + 2};
    std::deque<std::string> waiting_;
    std::size_t waiting_size_ = 0;
    bool closed_ = false;
};

Manager::Manager(boost::asio::io_context& io, Options options)
    : io_(io),
      options_(std::move(options)),
      settings_(options_.settings),
      acceptor_(io),
      control_(io),
      status_timer_(io),
      random_(options_.seed) {
    try {
        acceptor_.open(tcp::v4());
        acceptor_.set_option(tcp::acceptor::reuse_address(true));
        acceptor_.bind({tcp::v4(), options_.port});
        acceptor_.listen();
    } catch (const boost::system::system_error& error) {
        throw std::runtime_error("port " + std::to_string(options_.port) + ": " + error.code().message());
    }
    if (options_.control != 0) listen_for_settings();
    if (!options_.log.empty()) {
        log_.open(options_.log);
        if (!log_) throw std::runtime_error(options_.log + ": cannot be written");
        log_ << "time_s,event,from,to,hops,octets\n";
    }
    accept();
}

Manager::~Manager() = default;

double Manager::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begun_).count();
}

void Manager::note(const char* event, int from, int to, int hops, std::size_t octets) {
    if (!log_.is_open()) return;
    char line[160];
    std::snprintf(line, sizeof line, "%.6f,%s,%d,%d,%d,%zu\n", seconds(), event, from, to, hops, octets);
    log_ << line << std::flush;
}

void Manager::listen_for_settings() {
    using boost::asio::ip::udp;
    if (!control_.is_open()) {
        Error error;
        control_.open(udp::v4(), error);
        if (!error) control_.bind({udp::v4(), options_.control}, error);
        if (error)
            throw std::runtime_error("port " + std::to_string(options_.control) + ": " + error.message());
    }
    control_.async_receive_from(boost::asio::buffer(words_), asker_, [this](Error error, std::size_t size) {
        if (error == boost::asio::error::operation_aborted) return;
        if (!error) {
            const std::string answer = obey({words_.data(), size});
            // Whoever has no port wants no answer.
            Error none;
            if (asker_.port() != 0) control_.send_to(boost::asio::buffer(answer), asker_, 0, none);
        }
        listen_for_settings();
    });
}

/// The status, or what is wrong.
std::string Manager::obey(std::string_view words) {
    while (words.ends_with('\n') || words.ends_with('\r'))
        words.remove_suffix(1);
    std::string answer = apply_words(words, settings_);
    const std::string line(words.substr(0, words.find_first_of("\r\n")));
    if (answer.empty())
        std::printf("set %s\n", line.c_str());
    else
        std::printf("not set: %s\n", answer.c_str());
    std::fflush(stdout);
    note(answer.empty() ? "set" : "not_set", kEverybody, kEverybody, 0, words.size());
    stir();
    return (answer.empty() ? traffic_.status(seconds(), settings_, places_) : answer) + "\n";
}

void Manager::stir() {
    if (status_due_ || options_.status_every.count() == 0) return;
    status_due_ = true;
    status_timer_.expires_after(options_.status_every);
    status_timer_.async_wait([this](Error error) {
        if (!error) print_status();
    });
}

void Manager::print_status() {
    status_due_ = false;
    std::printf("status %s\n", traffic_.status(seconds(), settings_, places_).c_str());
    std::fflush(stdout);
}

bool Manager::is_lost(int from, int to) {
    const double loss = settings_.loss_between(from, to);
    if (loss <= 0) return false;
    constexpr double kSteps = 9007199254740992.0;  // 2^53
    return static_cast<double>(random_() >> 11) / kSteps < loss;
}

int Manager::number_of(const boost::asio::ip::address& address) const {
    const auto known = options_.numbers.find(address.to_string());
    if (known != options_.numbers.end()) return known->second;
    return address.to_v4().to_bytes()[3];
}

void Manager::accept() {
    acceptor_.async_accept([this](Error error, tcp::socket socket) {
        if (error == boost::asio::error::operation_aborted) return;
        if (!error) welcome(std::move(socket));
        accept();
    });
}

void Manager::welcome(tcp::socket socket) {
    Error error;
    const tcp::endpoint peer = socket.remote_endpoint(error);
    if (error) return;
    socket.set_option(tcp::no_delay(true), error);
    const int number = number_of(peer.address());
    // The robot connects again, and its old connection is not known to be gone.
    if (const auto old = clients_.find(number); old != clients_.end()) {
        old->second->close();
        note("replaced", number, number, 0, 0);
    }
    std::printf("robot %d connected from %s\n", number, peer.address().to_string().c_str());
    std::fflush(stdout);
    note("connected", number, number, 0, 0);
    auto client = std::make_shared<Client>(*this, std::move(socket), number);
    clients_[number] = client;
    places_.try_emplace(number);
    stir();
    client->read();
}

void Manager::gone(Client& client, const std::string& why) {
    const auto known = clients_.find(client.number());
    if (known == clients_.end() || known->second.get() != &client) return;
    std::printf("robot %d disconnected: %s\n", client.number(), why.c_str());
    std::fflush(stdout);
    note("disconnected", client.number(), client.number(), 0, 0);
    const std::shared_ptr<Client> kept = known->second;
    clients_.erase(known);
    places_.erase(client.number());
    stir();
    kept->close();
}

void Manager::receive(Client& client, std::string_view line) {
    const auto message = parse_message(line);
    const int from = client.number();
    if (!message) return note("bad", from, kEverybody, 0, line.size());
    if (message->place) places_[from] = message->place;
    const auto hops = reached(places_, from, settings_.limits);
    if (message->to == kEverybody) {
        note("all", from, kEverybody, 0, message->data.size());
        for (const auto& [to, count] : hops)
            pass(from, to, count, message->data);
    } else if (const auto count = hops.find(message->to); count != hops.end()) {
        pass(from, message->to, count->second, message->data);
    } else {
        const char* fate = clients_.contains(message->to) ? "too_far" : "absent";
        note(fate, from, message->to, 0, message->data.size());
        traffic_.add(seconds(), from, message->to, 0, message->data, fate);
        stir();
    }
}

void Manager::pass(int from, int to, int hops, const std::string& data) {
    const auto deliver = [this, from, to, hops, data] {
        const auto client = clients_.find(to);
        const char* fate = "passed";
        if (client == clients_.end())
            fate = "absent";
        else if (is_lost(from, to) || !client->second->write(line_from(from, data)))
            fate = "lost";
        note(fate, from, to, hops, data.size());
        traffic_.add(seconds(), from, to, hops, data, fate);
        stir();
    };
    if (settings_.hop_delay.count() == 0) return deliver();
    auto timer = std::make_shared<boost::asio::steady_timer>(io_, hops * settings_.hop_delay);
    timer->async_wait([timer, deliver](Error error) {
        if (!error) deliver();
    });
}

}  // namespace puckloop::netmanager
