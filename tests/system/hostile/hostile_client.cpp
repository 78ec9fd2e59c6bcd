#include "hostile_client.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

#include "answers.hpp"
#include "reader.hpp"
#include "requests.hpp"

namespace metier::hostile {

namespace {

using namespace std::chrono_literals;

constexpr std::size_t kHeader = 8;
constexpr std::size_t kMostKept = 40;

/// One field in so many is wrong: in none, in a few, in many.
std::size_t anyRate(Random& random) {
    constexpr std::array<std::size_t, 5> rates{0, 0, 150, 60, 15};
    return random.pick(rates);
}

}  // namespace

HostileClient::HostileClient(Target target, const AddressMap& map, Tally& tally)
    : target_(std::move(target)), tally_(tally), known_{.map = map, .endpoint_url = target_.url} {}

void HostileClient::send(std::uint64_t seed, std::uint64_t number) {
    constexpr std::uint64_t spell = 400;
    Random random(seed, number);
    number_ = number;
    listens_ = number / spell % 8 != 7;  // now and then it does not take its answers
    if (!socket_.isOpen()) {
        stage_ = Stage::disconnected;
    }
    const auto rate = anyRate(random);
    if (stage_ != Stage::disconnected && random.oneIn(60)) {
        return sendOther(random);
    }
    switch (stage_) {
        case Stage::disconnected:
            return sendHello(random);
        case Stage::connected:
        case Stage::greeted:
            return sendOpen(random, rate);
        case Stage::opened:
        case Stage::created:
            return random.oneIn(4) ? sendRequest(random, rate) : sendSession(random, rate);
        case Stage::active:
            sendRequest(random, rate);
    }
}

void HostileClient::sendHello(Random& random) {
    received_.clear();
    in_parts_ = false;
    channel_ = {};
    if (!socket_.connect(target_.port)) {
        tally_.defects.push_back(fmt::format("message {}: nobody takes a connection", number_));
        return;
    }
    ++tally_.connections;
    stage_ = Stage::connected;
    const std::size_t rate = random.oneIn(8) ? 4 : 0;
    transmit(hello(Writer(random, rate), target_.url));
    awaitStage(Stage::greeted, rate);
}

void HostileClient::sendOpen(Random& random, std::size_t wrong_one_in) {
    auto body = openSecureChannel(Writer(random, wrong_one_in), Renewal::issue);
    const bool damaged = random.oneIn(30);
    if (damaged) {
        damage(random, body);
    }
    if (target_.kind == ServerKind::closed && random.oneIn(2)) {
        transmit(secureOpenChunk(random, channel_, target_.certificates, body));
        return awaitStage(Stage::opened, 1);
    }
    // The server answers only after it has got a right HEL.
    const bool is_right = stage_ == Stage::greeted && !damaged && wrong_one_in == 0;
    transmit(openChunk(channel_, body));
    awaitStage(Stage::opened, is_right ? 0 : 1);
}

void HostileClient::sendSession(Random& random, std::size_t wrong_one_in) {
    constexpr int most_attempts = 4;
    if (stage_ == Stage::opened && attempts_ >= most_attempts) {
        known_.authentication_token = standardId(0);  // the server has forgotten it
    }
    const bool has_one = known_.authentication_token != standardId(0);
    Writer writer(random, wrong_one_in);
    const auto body = has_one ? activateSession(std::move(writer), known_)
                              : createSession(std::move(writer), known_);
    attempts_ = has_one ? attempts_ + 1 : 0;
    transmit(chunks(random, channel_, body, 0));
    // Whether it lets this one in is the server's to say.
    awaitStage(has_one ? Stage::active : Stage::created, 1);
}

void HostileClient::sendRequest(Random& random, std::size_t wrong_one_in) {
    const auto token = known_.authentication_token;
    if (random.oneIn(80)) {
        known_.authentication_token = numericId(1, static_cast<std::uint32_t>(random.next()));
    }
    auto body = message(Writer(random, wrong_one_in), anyRequest(random), known_);
    known_.authentication_token = token;
    if (random.oneIn(8)) {
        damage(random, body);
    }
    auto bytes = chunks(random, channel_, body, 40);
    if (random.oneIn(100)) {
        damage(random, bytes);
    }
    transmit(bytes);
    receive(0ms);
}

void HostileClient::sendOther(Random& random) {
    switch (random.below(6)) {
        case 0:
            transmit(hello(Writer(random, 10), target_.url));
            break;
        case 1:
            transmit(openChunk(channel_, openSecureChannel(Writer(random, 50), Renewal::renew)));
            break;
        case 2:
            transmit(closeChunk(channel_, "\x01"));
            break;
        case 3:
            transmit(chunks(random, channel_, closeSession(Writer(random, 0), known_), 0));
            known_.authentication_token = standardId(0);
            stage_ = std::min(stage_, Stage::opened);
            break;
        case 4: {
            Bytes noise(random.below(3'000), '\0');
            damage(random, noise);
            transmit(noise);
            if (stage_ == Stage::greeted) {
                stage_ = Stage::connected;  // the next bytes may be taken for the rest of it
            }
            break;
        }
        default:
            drop();
    }
    receive(0ms);
}

void HostileClient::transmit(std::string_view bytes) {
    socket_.send(bytes, 20ms);
}

void HostileClient::drop() {
    socket_.reset();
    stage_ = Stage::disconnected;
}

void HostileClient::awaitStage(Stage stage, std::size_t wrong_one_in) {
    const auto begin = std::chrono::steady_clock::now();
    const auto longest = wrong_one_in == 0 ? kLongestAnswer : 10ms;
    while (stage_ < stage && socket_.isOpen() &&
           std::chrono::steady_clock::now() - begin < longest) {
        const auto answers = tally_.answers;
        receive(longest);
        if (tally_.answers != answers && wrong_one_in != 0) {
            return;
        }
    }
    if (wrong_one_in == 0 && stage_ < stage && socket_.isOpen()) {
        tally_.defects.push_back(fmt::format("message {}: a right one got no answer within {} ms",
                                             number_,
                                             std::chrono::milliseconds(kLongestAnswer).count()));
    }
}

void HostileClient::receive(std::chrono::milliseconds longest) {
    constexpr std::size_t size_offset = 4;
    if (!listens_ && longest == 0ms) {
        return;
    }
    socket_.receive(received_, longest);
    std::string_view rest(received_);
    while (rest.size() >= kHeader) {
        const auto size = Reader(rest.substr(size_offset)).number<std::uint32_t>();
        if (size < kHeader || size > rest.size()) {
            break;
        }
        take(rest.substr(0, size));
        rest.remove_prefix(size);
    }
    received_.erase(0, received_.size() - rest.size());
}

void HostileClient::take(std::string_view chunk) {
    const auto type = chunk.substr(0, 3);
    if (type == "ACK") {
        stage_ = std::max(stage_, Stage::greeted);
    } else if (type == "OPN") {
        takeOpened(chunk.substr(kHeader));
    } else if (type == "MSG" && chunk[3] == 'F' && !std::exchange(in_parts_, false)) {
        takeMessage(chunk.substr(kHeader));
    } else {
        in_parts_ = chunk[3] == 'C';
    }
}

void HostileClient::takeOpened(std::string_view chunk) {
    constexpr std::size_t sequence = 8;
    Reader reader(chunk);
    reader.number<std::uint32_t>();
    for (int field = 0; field < 3; ++field) {
        reader.text();
    }
    reader.raw(sequence);
    const auto header = readHeader(reader);
    reader.number<std::uint32_t>();
    const auto id = reader.number<std::uint32_t>();
    const auto token = reader.number<std::uint32_t>();
    ++tally_.answers;
    if (reader.ok() && header.type == kOpenSecureChannelResponse && header.result == 0) {
        channel_.id = id;
        channel_.token = token;
        stage_ = std::max(stage_, Stage::opened);
    }
}

void HostileClient::takeMessage(std::string_view chunk) {
    constexpr std::size_t symmetric = 16;
    Reader reader(chunk);
    reader.raw(symmetric);
    const auto header = readHeader(reader);
    ++tally_.answers;
    if (!reader.ok()) {
        tally_.defects.push_back(fmt::format("message {}: an answer that is none", number_));
        return;
    }
    tally_.faults += header.type == kServiceFault ? 1U : 0U;
    judge(header.type, header.result, reader.rest());
}

void HostileClient::judge(std::uint32_t type, std::uint32_t result, std::string_view content) {
    const auto wrong = target_.kind == ServerKind::closed ? givenAway(type, result)
                                                          : permitted(type, result, content);
    if (!wrong.empty()) {
        tally_.defects.push_back(fmt::format("message {}: {}", number_, wrong));
    }
    if (result == kBadSessionIdInvalid) {
        stage_ = std::min(stage_, Stage::opened);
    }
    if (result != 0) {
        return;
    }
    Reader reader(content);
    if (type == kCreateSessionResponse) {
        reader.id();
        known_.authentication_token = reader.id();
        stage_ = std::max(stage_, Stage::created);
    } else if (type == kActivateSessionResponse) {
        ++tally_.sessions;
        attempts_ = 0;
        stage_ = Stage::active;
    } else {
        learn(type, reader, known_);
    }
    for (auto* ids : {&known_.subscriptions, &known_.items}) {
        if (ids->size() > kMostKept) {
            ids->erase(ids->begin());
        }
    }
}

}  // namespace metier::hostile
