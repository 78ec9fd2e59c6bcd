// The SecureChannel, Session and Discovery services.
#include <array>

#include "odd_values.hpp"
#include "requests.hpp"

namespace metier::hostile {

namespace {

constexpr std::uint32_t kOpenSecureChannel = 446;
constexpr std::uint32_t kCreateSession = 461;
constexpr std::uint32_t kActivateSession = 467;
constexpr std::uint32_t kCloseSession = 473;

void writeDescription(Writer& writer) {
    writer.text("urn:hostile");
    writer.text("urn:hostile");
    writer.localizedText("hostile client");
    writer.number(std::uint32_t{1});
    writer.noText();
    writer.noText();
    const auto urls = writer.random().below(3);
    writer.count(urls);
    for (std::size_t i = 0; i < urls; ++i) {
        writer.text("opc.tcp://elsewhere:4840");
    }
}

void writeTexts(Writer& writer, std::string_view text) {
    const auto texts = writer.random().below(writer.random().oneIn(30) ? 400 : 3);
    writer.count(texts);
    for (std::size_t i = 0; i < texts; ++i) {
        writer.text(text);
    }
}

void writeNonce(Writer& writer) {
    constexpr std::array<std::size_t, 6> lengths{0, 1, 31, 32, 33, 5'000};
    writer.text(Bytes(writer.isWrong() ? writer.random().pick(lengths) : 32, '\x5a'));
}

void writeCertificate(Writer& writer) {
    if (!writer.isWrong()) {
        return writer.noText();
    }
    constexpr std::array<std::size_t, 4> lengths{1, 500, 1'200, 20'000};
    Bytes der(writer.random().pick(lengths), '\x30');
    for (std::size_t i = 1; i < der.size(); i += 7) {
        der[i] = static_cast<char>(writer.random().next());
    }
    writer.text(der);
}

void writeSignature(Writer& writer) {
    if (!writer.isWrong()) {
        writer.noText();
        return writer.noText();
    }
    writer.text("http://www.w3.org/2001/04/xmldsig-more#rsa-sha256");
    writer.text(Bytes(256, '\x77'));
}

void writeIdentity(Writer& writer, const Known& known) {
    constexpr std::uint32_t anonymous = 321;
    constexpr std::uint32_t user_name = 324;
    constexpr std::uint32_t x509 = 327;
    constexpr std::uint32_t issued = 940;
    Writer body = writer.fresh();
    body.text(known.anonymous_policy);
    if (!writer.isWrong()) {
        return writer.extension(anonymous, body.bytes());
    }
    switch (writer.random().below(4)) {
        case 0:
            body.text("operator");
            body.text("secret");
            body.text("http://www.w3.org/2001/04/xmlenc#rsa-oaep");
            return writer.extension(user_name, body.bytes());
        case 1:
            writeCertificate(body);
            return writer.extension(x509, body.bytes());
        case 2:
            body.text(Bytes(2'000, 't'));
            body.text("");
            return writer.extension(issued, body.bytes());
        default:
            writer.id(standardId(0));
            return writer.exactly(std::uint8_t{0});
    }
}

void writeNothing(Writer& writer, const Known& /*known*/) {
    writer.raw(Bytes(writer.random().below(60), '\x01'));
}

void writeFindServers(Writer& writer, const Known& known) {
    writer.text(known.endpoint_url);
    writeTexts(writer, "en");
    writeTexts(writer, "urn:metier:server");
}

void writeRegisterServer(Writer& writer, const Known& /*known*/) {
    writer.text("urn:hostile");
    writer.text("urn:hostile");
    writer.count(1);
    writer.localizedText("hostile server");
    writer.number(std::uint32_t{0});
    writer.noText();
    writeTexts(writer, "opc.tcp://elsewhere:4840");
    writer.noText();
    writer.boolean(true);
}

void writeCancel(Writer& writer, const Known& /*known*/) {
    writer.number(static_cast<std::uint32_t>(writer.random().below(1'000)));
}

void writeCreateSessionBody(Writer& writer, const Known& known) {
    writeDescription(writer);
    writer.noText();
    writer.text(known.endpoint_url);
    writer.text("a session of a hostile client");
    writeNonce(writer);
    writeCertificate(writer);
    writer.real(5'000);
    writer.number(std::uint32_t{0});
}

void writeActivateSessionBody(Writer& writer, const Known& known) {
    writeSignature(writer);
    writer.count(0);
    writeTexts(writer, "en");
    writeIdentity(writer, known);
    writeSignature(writer);
}

void writeCloseSessionBody(Writer& writer, const Known& /*known*/) {
    writer.boolean(!writer.random().oneIn(4));
}

void writeOpenBody(Writer& writer, Renewal renewal) {
    writer.number(std::uint32_t{0});
    writer.number(renewal == Renewal::renew ? std::uint32_t{1} : std::uint32_t{0});
    writer.number(std::uint32_t{1});
    writeNonce(writer);
    writer.number(std::uint32_t{600'000});
}

void writeHeader(Writer& writer, std::uint32_t type, std::string_view token) {
    writer.id(standardId(type));
    writer.id(token);
    writer.time();
    writer.number(static_cast<std::uint32_t>(writer.random().below(1'000)));
    writer.number(std::uint32_t{0});
    if (writer.isWrong()) {
        writer.text("audit entry");
    } else {
        writer.noText();
    }
    writer.number(std::uint32_t{10'000});
    if (!writer.isWrong()) {
        writer.raw(Bytes(3, '\0'));
        return;
    }
    Writer body = writer.fresh();
    writeDescription(body);
    writer.extension(308, body.bytes());
}

}  // namespace

std::span<const Request> discoveryRequests() {
    static constexpr std::array<Request, 9> requests{
        {{422, writeFindServers, 2},
         {428, writeFindServers, 2},
         {12'208, writeFindServers, 1},
         {437, writeRegisterServer, 1},
         {12'211, writeRegisterServer, 1},
         {479, writeCancel, 1},
         // Messages of no service: a response, a fault, nothing.
         {464, writeNothing, 1},
         {397, writeNothing, 1},
         {64'000, writeNothing, 1}}};
    return requests;
}

const Request& anyRequest(Random& random) {
    const std::array groups{attributeRequests(), nodeRequests(), subscriptionRequests(),
                            discoveryRequests()};
    std::size_t all = 0;
    for (const auto& group : groups) {
        for (const auto& request : group) {
            all += request.weight;
        }
    }
    auto left = random.below(all);
    for (const auto& group : groups) {
        for (const auto& request : group) {
            if (left < request.weight) {
                return request;
            }
            left -= request.weight;
        }
    }
    return attributeRequests().front();
}

Bytes message(Writer writer, const Request& request, const Known& known) {
    writeHeader(writer, request.type, known.authentication_token);
    request.write(writer, known);
    return writer.take();
}

Bytes openSecureChannel(Writer writer, Renewal renewal) {
    writeHeader(writer, kOpenSecureChannel, standardId(0));
    writeOpenBody(writer, renewal);
    return writer.take();
}

Bytes createSession(Writer writer, const Known& known) {
    return message(std::move(writer), {kCreateSession, writeCreateSessionBody, 0}, known);
}

Bytes activateSession(Writer writer, const Known& known) {
    return message(std::move(writer), {kActivateSession, writeActivateSessionBody, 0}, known);
}

Bytes closeSession(Writer writer, const Known& known) {
    return message(std::move(writer), {kCloseSession, writeCloseSessionBody, 0}, known);
}

}  // namespace metier::hostile
