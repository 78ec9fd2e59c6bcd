#pragma once

#include "metier/base/error.hpp"
#include "metier/opcua/address_space.hpp"

namespace metier::opcua_skill {

/// Publishes, below the server's Dictionaries, the purposes of its skill types in terms of a task:
/// each type refers to its entries by HasDictionaryEntry (OPC 10000-19). A client that looks for
/// "grasp" needs to know no type. Types that the server does not have are left out.
/// Threads: those of AddressSpace; call it once, before Server::start().
/// Errors: not_found (a NodeSet is missing), already_exists (twice in one server).
Result<void> publishDictionary(opcua::AddressSpace& nodes);

}  // namespace metier::opcua_skill
