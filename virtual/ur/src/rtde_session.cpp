#include "rtde_session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "metier/base/text.hpp"

namespace metier::virtual_ur {

namespace {

constexpr std::string_view kSource = "RTDE";  // source of text messages

constexpr std::size_t kHeader = 3;
constexpr std::size_t kMostRecipes = 255;
constexpr std::size_t kLongestList = 2048;
// A client that leaves more than this unread gets no further samples [bytes].
constexpr std::size_t kMostUnreadRtde = 64'000;

constexpr std::uint8_t kError = 1;
constexpr std::uint8_t kWarning = 2;

/// Names of a recipe. One comma may follow the last of them: there are clients that write one
/// behind each name.
std::vector<std::string> namesIn(std::string_view list) {
    const auto names = split(list, ',');
    const bool comma_behind = names.size() > 1 && names.back().empty();
    return {names.begin(), names.end() - (comma_behind ? 1 : 0)};
}

}  // namespace

RtdeSession::RtdeSession(RtdeShared& shared, virtual_controller::TcpPeer& peer)
    : shared_(shared), peer_(peer) {}

RtdeSession::~RtdeSession() {
    for (const auto& name : claimed_) {
        shared_.claimed.erase(name);
    }
}

Result<void> RtdeSession::receive(std::span<const std::byte> bytes) {
    received_.insert(received_.end(), bytes.begin(), bytes.end());
    std::size_t done = 0;
    const std::span<const std::byte> all(received_);
    while (all.size() - done >= kHeader) {
        ByteReader header(all.subspan(done));
        const std::size_t size = header.get<std::uint16_t>();
        const auto type = static_cast<char>(header.get<std::uint8_t>());
        if (size < kHeader) {
            return fail(Errc::invalid_argument,
                        fmt::format("RTDE package of {} bytes, a header has 3", size));
        }
        if (all.size() - done < size) {
            break;
        }
        handle(type, all.subspan(done + kHeader, size - kHeader));
        done += size;
    }
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(done));
    return {};
}

void RtdeSession::handle(char type, std::span<const std::byte> payload) {
    const ByteReader reader(payload);
    switch (type) {
        case 'V':
            return negotiate(reader);
        case 'v':
            return answerVersion();
        case 'O':
            return setUpOutputs(reader);
        case 'I':
            return setUpInputs(reader.rest());
        case 'U':
            return takeInputs(reader);
        case 'S':
            return answerStart();
        case 'P':
            started_ = false;
            return answer('P', 1);
        case 'M':  // a text of the client
            return;
        default:
            return sendText(kError, fmt::format("unknown package type {}", static_cast<int>(type)));
    }
}

void RtdeSession::negotiate(ByteReader payload) {
    const auto wanted = payload.get<std::uint16_t>();
    const bool accepted = payload.complete() && (wanted == 1 || wanted == 2);
    if (accepted) {
        protocol_ = wanted;
    }
    answer('V', static_cast<std::uint8_t>(accepted));
}

void RtdeSession::answerVersion() {
    const auto& version = shared_.version;
    sendPackage('v', ByteWriter()
                         .put(version.major)
                         .put(version.minor)
                         .put(version.bugfix)
                         .put(version.build)
                         .content());
}

void RtdeSession::setUpOutputs(ByteReader payload) {
    const double frequency = protocol_ == 1 ? shared_.rate : payload.get<double>();
    const auto list = payload.rest();
    outputs_ = {};
    started_ = false;
    std::vector<std::string> types;
    bool valid = payload.complete() && std::isfinite(frequency) && frequency > 0.0 &&
                 list.size() <= kLongestList;
    for (const auto& name : namesIn(list)) {
        const auto variable = RtdeVariable::output(name);
        valid = valid && variable;
        types.emplace_back(variable ? variable->typeName() : "NOT_FOUND");
        if (variable) {
            outputs_.variables.push_back(*variable);
        }
    }
    if (valid && !types.empty()) {
        outputs_.every =
            static_cast<std::uint64_t>(std::max(1.0, std::floor(shared_.rate / frequency)));
    } else {
        outputs_ = {};
    }
    ByteWriter answered;
    if (protocol_ == 2) {
        answered.put(static_cast<std::uint8_t>(!outputs_.variables.empty()));
    }
    answered.text(fmt::format("{}", fmt::join(types, ",")));
    sendPackage('O', answered.content());
}

void RtdeSession::setUpInputs(std::string_view list) {
    InputRecipe recipe{namesIn(list), {}, 0};
    std::vector<std::string> types;
    bool valid =
        !recipe.names.empty() && list.size() <= kLongestList && inputs_.size() < kMostRecipes;
    for (const auto& name : recipe.names) {
        const auto variable = RtdeVariable::input(name);
        const bool in_use = shared_.claimed.contains(name) && !claimed_.contains(name);
        valid = valid && variable && !in_use;
        if (!variable) {
            types.emplace_back("NOT_FOUND");
        } else {
            types.emplace_back(in_use ? "IN_USE" : variable->typeName());
            recipe.variables.push_back(*variable);
            recipe.size += variable->size();
        }
    }
    if (valid) {
        shared_.claimed.insert(recipe.names.begin(), recipe.names.end());
        claimed_.insert(recipe.names.begin(), recipe.names.end());
        inputs_.push_back(std::move(recipe));
    }
    ByteWriter answered;
    answered.put(static_cast<std::uint8_t>(valid ? inputs_.size() : 0))
        .text(fmt::format("{}", fmt::join(types, ",")));
    sendPackage('I', answered.content());
}

void RtdeSession::takeInputs(ByteReader payload) {
    const std::size_t id = payload.get<std::uint8_t>();
    if (id == 0 || id > inputs_.size()) {
        return sendText(kWarning, fmt::format("input recipe {} is not set up", id));
    }
    const auto& recipe = inputs_[id - 1];
    if (payload.left() != recipe.size) {
        return sendText(kError, fmt::format("input recipe {} has {} bytes, {} came", id,
                                            recipe.size, payload.left()));
    }
    for (const auto& variable : recipe.variables) {
        variable.take(payload, shared_.inputs);
    }
    shared_.written(recipe.names);
}

void RtdeSession::answerStart() {
    started_ = !outputs_.variables.empty();
    cycles_ = 0;
    answer('S', static_cast<std::uint8_t>(started_));
}

void RtdeSession::cycle(const RobotState& state) {
    if (!started_ || cycles_++ % outputs_.every != 0 || peer_.queued() > kMostUnreadRtde) {
        return;
    }
    ByteWriter payload;
    if (protocol_ == 2) {
        payload.put(std::uint8_t{1});
    }
    for (const auto& variable : outputs_.variables) {
        variable.append(state, payload);
    }
    sendPackage('U', payload.content());
}

void RtdeSession::sendPackage(char type, std::span<const std::byte> payload) {
    ByteWriter package;
    package.put(static_cast<std::uint16_t>(kHeader + payload.size()))
        .put(static_cast<std::uint8_t>(type))
        .bytes(payload);
    peer_.send(package.content());
}

void RtdeSession::answer(char type, std::uint8_t value) {
    const std::array payload{static_cast<std::byte>(value)};
    sendPackage(type, payload);
}

void RtdeSession::sendText(std::uint8_t level, std::string_view text) {
    ByteWriter payload;
    if (protocol_ == 1) {
        payload.put(level).text(text);
    } else {
        payload.put(static_cast<std::uint8_t>(text.size())).text(text);
        payload.put(static_cast<std::uint8_t>(kSource.size())).text(kSource).put(level);
    }
    sendPackage('M', payload.content());
}

}  // namespace metier::virtual_ur
