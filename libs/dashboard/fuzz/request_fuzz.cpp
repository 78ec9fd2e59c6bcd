// Reading of requests with any content: the first byte chooses the kind of the others.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "access.hpp"
#include "commands.hpp"
#include "metier/skill/json.hpp"
#include "outbox.hpp"
#include "records_view.hpp"
#include "reply.hpp"
#include "skill_shown.hpp"

namespace {

using namespace metier::dashboard;

/// A skill with a parameter of every type.
const metier::skill::SkillDescription& skill() {
    static const auto kSkill = [] {
        metier::skill::SkillDescription one;
        one.name = "Skill";
        for (int type = 1; type <= static_cast<int>(metier::skill::ValueType::frames); ++type) {
            metier::skill::Field field;
            field.name = std::string(1, static_cast<char>('a' + type));
            field.type = static_cast<metier::skill::ValueType>(type);
            one.parameters.push_back(std::move(field));
        }
        return one;
    }();
    return kSkill;
}

void require(bool holds) {
    if (!holds) {
        std::abort();
    }
}

void readBody(std::string_view text) {
    const auto body = parseBody(text);
    if (!body) {
        return require(!body.error().message.empty());
    }
    for (const auto* name : {"tab", "key", "user", "password", "action"}) {
        const auto there = textIn(*body, name);
        require(!there || !there->empty());
    }
    const auto values = parametersIn(*body, skill());
    if (!values) {
        return require(!values.error().message.empty() && values.error().message.size() < 500);
    }
    // A value that was accepted is printed as the same value.
    const auto told = metier::skill::toJson(*values);
    const auto again = parametersIn({{"parameters", inLists(told)}}, skill());
    require(again && *again == *values);
    const auto text_of_it = dump(told);
    require(text_of_it.find('\n') == std::string::npos);
}

void readHead(std::string_view text) {
    httplib::Request request;
    const auto half = text.size() / 2;
    request.headers = {{"Host", std::string(text.substr(0, half))},
                       {"Origin", std::string(text.substr(half))},
                       {"Cookie", std::string(text)}};
    static_cast<void>(checkOrigin(request, ""));
    static_cast<void>(checkIntent(request));
    require(cookie(request, "metier").find(';') == std::string::npos);
}

void readQuery(std::string_view text) {
    httplib::Request request;
    for (const auto* name : {"from", "to", "count", "before"}) {
        request.params = {{name, std::string(text)}};
        const auto query = recordsQuery(request);
        require(!query || (query->second.count >= 1 && query->second.count <= 1'000));
    }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) {
        return 0;
    }
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    switch (data[0] % 4) {
        case 0:
            readHead(text);
            break;
        case 1:
            readQuery(text);
            break;
        default:
            readBody(text);
    }
    return 0;
}
