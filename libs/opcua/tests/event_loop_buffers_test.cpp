// Data on its way between the stack and a socket, and what the stack wants to be opened.
#include <gmock/gmock.h>
#include <open62541/types_generated_handling.h>

#include <array>
#include <string>
#include <vector>

#include "send_queue.hpp"
#include "tcp_parameters.hpp"

namespace metier::opcua {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

NetworkBuffer bufferOf(std::string_view text) {
    const UA_String view = asStackString(text);
    UA_ByteString bytes;
    EXPECT_EQ(UA_ByteString_copy(&view, &bytes), UA_STATUSCODE_GOOD);
    NetworkBuffer buffer(&bytes);
    EXPECT_EQ(bytes.data, nullptr) << "taken over";
    return buffer;
}

std::string frontOf(const SendQueue& queue) {
    const auto bytes = queue.front();
    return {bytes.begin(), bytes.end()};
}

TEST(SendQueue, GivesItsBytesOldestFirstHoweverFewAreTaken) {
    SendQueue queue;
    queue.push(bufferOf("abc"));
    queue.push(bufferOf("de"));
    std::string sent;
    for (std::size_t left = 5; left > 0; --left) {
        ASSERT_EQ(queue.size(), left);
        sent += frontOf(queue).front();
        queue.consume(1);
    }
    EXPECT_EQ(sent, "abcde");
    EXPECT_TRUE(queue.empty());
}

TEST(SendQueue, GoesOnWithTheRestOfABuffer) {
    SendQueue queue;
    queue.push(bufferOf("abc"));
    queue.consume(2);
    queue.push(bufferOf("de"));
    EXPECT_EQ(frontOf(queue), "c");
    EXPECT_EQ(queue.size(), 3U);
    queue.clear();
    EXPECT_TRUE(queue.empty());
    EXPECT_EQ(queue.size(), 0U);
    queue.push(bufferOf("f"));
    EXPECT_EQ(frontOf(queue), "f");
}

/// Parameters as the stack gives them; `port` and `address` are left out if they have no type.
class Parameters {
public:
    explicit Parameters(std::vector<std::string> addresses) : addresses_(std::move(addresses)) {
        for (const auto& address : addresses_) {
            native_.push_back(asStackString(address));
        }
        add("port", &port_, UA_TYPES_UINT16);
        UA_Variant_setArray(&add("address"), native_.data(), native_.size(),
                            &UA_TYPES[UA_TYPES_STRING]);
    }
    UA_Variant& add(const char* key) {
        pairs_.push_back({{0, asStackString(key)}, {}});
        return pairs_.back().value;
    }
    void add(const char* key, void* value, std::size_t type) {
        UA_Variant_setScalar(&add(key), value, &UA_TYPES[type]);
    }
    UA_Variant& port() { return pairs_[0].value; }
    UA_Variant& address() { return pairs_[1].value; }
    void listen() { add("listen", &yes_, UA_TYPES_BOOLEAN); }
    Result<TcpParameters> read() {
        const UA_KeyValueMap map{pairs_.size(), pairs_.data()};
        return readTcpParameters(&map);
    }

private:
    std::vector<std::string> addresses_;
    std::vector<UA_String> native_;
    UA_UInt16 port_ = 4840;
    UA_Boolean yes_ = true;
    std::vector<UA_KeyValuePair> pairs_;
};

TEST(TcpParameters, NameOneHostToConnectTo) {
    const auto read = Parameters({"host"}).read();
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_THAT(read->addresses, ElementsAre("host"));
    EXPECT_EQ(read->port, 4840);
    EXPECT_FALSE(read->listen);
    EXPECT_FALSE(read->validate);
    for (const auto& addresses : std::vector<std::vector<std::string>>{{}, {"one", "two"}}) {
        const auto refused = Parameters(addresses).read();
        ASSERT_FALSE(refused);
        EXPECT_THAT(refused.error().message, HasSubstr("must name one host"));
    }
}

TEST(TcpParameters, NameAnyNumberOfAddressesToListenOn) {
    Parameters two({"127.0.0.1", "::1"});
    two.listen();
    EXPECT_THAT(two.read()->addresses, ElementsAre("127.0.0.1", "::1"));
    Parameters all({});
    all.listen();
    EXPECT_THAT(all.read()->addresses, IsEmpty());
    Parameters one({});
    one.listen();
    UA_String host = asStackString("host");
    UA_Variant_setScalar(&one.address(), &host, &UA_TYPES[UA_TYPES_STRING]);
    EXPECT_THAT(one.read()->addresses, ElementsAre("host")) << "a scalar, too";
}

TEST(TcpParameters, AreRefusedWithAValueOfAnotherType) {
    UA_UInt32 wide = 4840;
    Parameters with_port({"host"});
    UA_Variant_setScalar(&with_port.port(), &wide, &UA_TYPES[UA_TYPES_UINT32]);
    EXPECT_EQ(with_port.read().error().message, "TCP parameter port is missing");
    Parameters with_address({"host"});
    UA_Variant_setScalar(&with_address.address(), &wide, &UA_TYPES[UA_TYPES_UINT32]);
    EXPECT_EQ(with_address.read().error().message, "TCP parameter address is not a string");
    Parameters with_flag({"host"});
    with_flag.add("validate", &wide, UA_TYPES_UINT32);
    EXPECT_FALSE(with_flag.read()->validate);
}

}  // namespace
}  // namespace metier::opcua
