// Loads all NodeSets into a node-opcua address space and compares it with what the XML files say:
// every node is there with its class, every reference is there from both ends, types resolve, and
// instances have the mandatory children of their types.
//
//   node load_with_node_opcua.mjs <folder of node_modules> <NodeSet2.xml of OPC UA> <official>... -- <ours>...
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [modules, ...files] = process.argv.slice(2);
const separator = files.indexOf("--");
if (!modules || separator < 1) {
    console.error("usage: load_with_node_opcua.mjs <node_modules> <base> <official>... -- <ours>...");
    process.exit(2);
}
const official = files.slice(0, separator);
const ours = files.slice(separator + 1);
const require = createRequire(path.join(path.resolve(modules), "index.js"));
const { AddressSpace, NodeClass } = require("node-opcua");
const { generateAddressSpace } = require("node-opcua-address-space/nodeJS.js");

const faults = [];
const fault = (text) => faults.push(text);

const attribute = (text, name) => new RegExp(`\\s${name}="([^"]*)"`).exec(text)?.[1];

/** Nodes and references of a NodeSet file of ours, with namespace URIs instead of indexes. */
function parse(file) {
    const xml = readFileSync(file, "utf8");
    const uris = ["http://opcfoundation.org/UA/", ...[...xml.matchAll(/<Uri>([^<]*)<\/Uri>/g)].map((m) => m[1])];
    const aliases = new Map([...xml.matchAll(/<Alias Alias="([^"]*)">([^<]*)<\/Alias>/g)].map((m) => [m[1], m[2]]));
    const id = (text) => {
        const plain = aliases.get(text) ?? text;
        const match = /^(?:ns=(\d+);)?(i=\d+)$/.exec(plain);
        return { uri: uris[Number(match[1] ?? 0)], identifier: match[2] };
    };
    const nodes = [];
    for (const [, kind, attributes, body] of xml.matchAll(/<UA(\w+) (NodeId=[^>]*)>(.*?)<\/UA\1>/gs)) {
        const references = [...body.matchAll(/<Reference ([^>]*)>([^<]*)<\/Reference>/g)].map((m) => ({
            type: id(attribute(` ${m[1]}`, "ReferenceType")),
            forward: attribute(` ${m[1]}`, "IsForward") !== "false",
            target: id(m[2]),
        }));
        const nodeId = id(attribute(` ${attributes}`, "NodeId"));
        nodes.push({ kind, id: nodeId, name: attribute(` ${attributes}`, "BrowseName"), references });
    }
    return nodes;
}

const addressSpace = AddressSpace.create();
await generateAddressSpace(addressSpace, [...official, ...ours]);

const local = ({ uri, identifier }) => `ns=${addressSpace.getNamespaceIndex(uri)};${identifier}`;
const find = (id) => addressSpace.findNode(local(id));

function checkReferences(node, found) {
    for (const reference of node.references) {
        const target = find(reference.target);
        if (!target) {
            fault(`${node.name}: target ${local(reference.target)} is not there`);
            continue;
        }
        const type = find(reference.type);
        const isSame = (r, other) =>
            r.nodeId.toString() === other.nodeId.toString() && r.referenceType.toString() === type.nodeId.toString();
        const seen = found.allReferences().some((r) => r.isForward === reference.forward && isSame(r, target));
        const seenBack = target.allReferences().some((r) => r.isForward !== reference.forward && isSame(r, found));
        // node-opcua keeps references to types and modelling rules at their source only.
        const oneWay = ["HasTypeDefinition", "HasModellingRule"].includes(type.browseName.name);
        if (!seen || (!seenBack && !oneWay)) {
            fault(`${node.name}: ${type.browseName.name} to ${target.browseName.toString()} is not there`);
        }
    }
}

function* typeChain(type) {
    for (let current = type; current; current = current.subtypeOfObj) {
        yield current;
        yield* current.findReferencesAsObject?.("HasInterface", true) ?? [];
    }
}

const childrenOf = (parent) => parent.findReferencesExAsObject("Aggregates");

/** Declarations of the types by BrowseName, the most derived first. */
function declarations(parents) {
    const found = new Map();
    for (const child of parents.flatMap(childrenOf)) {
        const name = child.browseName.toString();
        found.set(name, [...(found.get(name) ?? []), child]);
    }
    return found;
}

function checkMandatoryChildren(name, found, parents) {
    const have = new Map(childrenOf(found).map((c) => [c.browseName.toString(), c]));
    for (const [childName, sources] of declarations(parents)) {
        const child = have.get(childName);
        if (child) {
            checkMandatoryChildren(`${name}/${childName}`, child, sources);
        } else if (sources[0].modellingRule === "Mandatory") {
            fault(`${name}: mandatory child ${childName} is not there`);
        }
    }
}

function checkType(node, found) {
    const type = found.typeDefinitionObj;
    if (!type) {
        fault(`${node.name}: its type definition does not resolve`);
        return;
    }
    const interfaces = found.findReferencesAsObject("HasInterface", true);
    checkMandatoryChildren(node.name, found, [type, ...interfaces].flatMap((t) => [...typeChain(t)]));
}

let count = 0;
for (const node of ours.flatMap(parse)) {
    count += 1;
    const found = find(node.id);
    if (!found || NodeClass[found.nodeClass] !== node.kind) {
        fault(`${node.name} (${local(node.id)}) is not there as ${node.kind}`);
        continue;
    }
    checkReferences(node, found);
    if (node.kind === "Object" || node.kind === "Variable") {
        checkType(node, found);
    }
}
addressSpace.dispose();
for (const text of faults) {
    console.error(text);
}
console.log(`${count} nodes in ${ours.length} NodeSets, ${faults.length} faults`);
process.exit(faults.length === 0 && count > 0 ? 0 : 1);
