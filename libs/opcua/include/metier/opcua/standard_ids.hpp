#pragma once

#include "metier/opcua/node_id.hpp"

/// Nodes of namespace 0 that this project uses (OPC 10000-5, NodeIds of the standard).
/// They are the same in every server, so they may be kept for ever, unlike ids of other namespaces,
/// whose index must be looked up after each connection.
namespace metier::opcua::ids {

// A Variable of one of these types takes the type that Value::of() makes from the C++ type:
// kBoolean bool, kInt32 std::int32_t, kUInt32 std::uint32_t, kUInt64 std::uint64_t, kDouble double,
// kString std::string, kNodeId NodeId, kStatusCode StatusCode, kLocalizedText LocalizedText.
// Data types, for VariableSpec::data_type and Argument::data_type.
inline const NodeId kBoolean{0, 1U};
inline const NodeId kInt32{0, 6U};
inline const NodeId kUInt32{0, 7U};
inline const NodeId kUInt64{0, 9U};
inline const NodeId kDouble{0, 11U};
inline const NodeId kString{0, 12U};
inline const NodeId kNodeId{0, 17U};
inline const NodeId kStatusCode{0, 19U};
inline const NodeId kLocalizedText{0, 21U};
/// Supertype of all structures; a Value of one that this program does not know stays encoded.
inline const NodeId kStructure{0, 22U};
/// A value of any type, Null included.
inline const NodeId kBaseDataType{0, 24U};
/// Supertype of all enumerations, whose values travel as std::int32_t.
inline const NodeId kEnumeration{0, 29U};

// Types of references.
inline const NodeId kOrganizes{0, 35U};
inline const NodeId kHasEventSource{0, 36U};
inline const NodeId kHasEncoding{0, 38U};
inline const NodeId kHasTypeDefinition{0, 40U};
inline const NodeId kHasSubtype{0, 45U};
inline const NodeId kHasProperty{0, 46U};
inline const NodeId kHasComponent{0, 47U};
/// Events of the target are also events of the source: a subscriber of the source gets both.
inline const NodeId kHasNotifier{0, 48U};
/// Supertype of those references that make the tree; BrowseFilter and BrowseQuery follow it by
/// default.
inline const NodeId kHierarchicalReferences{0, 33U};
/// From an Object or its type to an interface type that it implements.
inline const NodeId kHasInterface{0, 17603U};

// Types of Objects, Variables and events.
inline const NodeId kBaseObjectType{0, 58U};
inline const NodeId kFolderType{0, 61U};
inline const NodeId kBaseDataVariableType{0, 63U};
/// Type of Variables with a range; their units are of subtypes.
inline const NodeId kBaseAnalogType{0, 15318U};
inline const NodeId kPropertyType{0, 68U};
inline const NodeId kBaseEventType{0, 2041U};
inline const NodeId kProgramStateMachineType{0, 2391U};
/// Events of every state machine; the one of Programs below is a subtype.
inline const NodeId kTransitionEventType{0, 2311U};
inline const NodeId kProgramTransitionEventType{0, 2378U};
/// Raised by libs/server for alarms of the server itself.
inline const NodeId kSystemEventType{0, 2130U};
/// Audit events are raised on the Server object; only sessions for which mayAudit() get their
/// fields.
inline const NodeId kAuditEventType{0, 2052U};
inline const NodeId kAuditSecurityEventType{0, 2058U};
inline const NodeId kAuditSessionEventType{0, 2069U};
inline const NodeId kAuditActivateSessionEventType{0, 2075U};
/// One for each reason for which the certificate of a peer was refused.
inline const NodeId kAuditCertificateExpiredEventType{0, 2085U};
inline const NodeId kAuditCertificateInvalidEventType{0, 2086U};
inline const NodeId kAuditCertificateUntrustedEventType{0, 2087U};
inline const NodeId kAuditCertificateRevokedEventType{0, 2088U};
inline const NodeId kAuditCertificateMismatchEventType{0, 2089U};
/// A call of a Method.
inline const NodeId kAuditUpdateMethodEventType{0, 2127U};

// Objects and Variables that every server has.
inline const NodeId kObjectsFolder{0, 85U};
/// URIs of the namespaces, in the order of their indices.
inline const NodeId kNamespaceArray{0, 2255U};
/// Root of all notifiers: a subscriber of its events gets those of every notifier below.
inline const NodeId kServer{0, 2253U};
/// Property of the Server: always true for a server of this library.
inline const NodeId kServerAuditing{0, 2994U};

}  // namespace metier::opcua::ids
