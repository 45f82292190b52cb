// An FMU whose library is WebAssembly, through its FMI 2.0 functions: what a master of FMUs does, in a page.

const OK = 0, WARNING = 1, DISCARD = 2;
const NANOSECONDS = 1e6;

/** What the library may call: its resources, its messages, a clock. */
function hostOf(memory, resources, hear) {
  const text = (at) => {
    const bytes = new Uint8Array(memory().buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  };
  return {
    dcone: {
      size: (name) => resources[text(name)]?.length ?? -1,
      read: (name, at) => new Uint8Array(memory().buffer).set(resources[text(name)], at),
      say: (status, at) => hear(status, text(at)),
    },
    wasi_snapshot_preview1: {
      clock_time_get: (clock, precision, at) => {
        new DataView(memory().buffer).setBigUint64(at, BigInt(Math.round(Date.now() * NANOSECONDS)), true);
        return 0;
      },
    },
  };
}

/** An instance of an FMU. What is wrong is thrown, in the FMU's own words. */
class Fmu {
  /**
   * model    module (a WebAssembly.Module), resources (bytes by name), guid, references ({name: [reference, kind]},
   *          kind "Real", "Integer" or "Boolean")
   */
  constructor(model) {
    this.references = model.references;
    this.said = [];
    const hear = (status, text) => { if (status > WARNING) this.said.push(text); };
    const host = hostOf(() => this.own.memory, model.resources, hear);
    const wanted = WebAssembly.Module.imports(model.module);
    for (const { module, name } of wanted) {
      host[module] ??= {};
      host[module][name] ??= () => { throw new Error(`the model calls ${module}.${name}, which a page does not have`); };
    }
    this.own = new WebAssembly.Instance(model.module, host).exports;
    this.own._initialize();
    const guid = this.text(model.guid), name = this.text("page"), nowhere = this.text("memory");
    this.instance = this.own.fmi2Instantiate(name, 1, guid, nowhere, this.own.dcone_callbacks(), 0, 0);
    for (const one of [guid, name, nowhere]) this.own.free(one);
    if (!this.instance) throw new Error(this.said.join("; ") || "the model gives no instance");
    this.room = 0;
  }

  text(words) {
    const bytes = new TextEncoder().encode(words + "\0"), at = this.own.malloc(bytes.length);
    new Uint8Array(this.own.memory.buffer).set(bytes, at);
    return at;
  }

  /** Whether a call went well; a discard is told apart, since the model may have come to its own end. */
  demand(status, doing) {
    if (status <= WARNING) return true;
    if (status === DISCARD) return false;
    throw new Error(this.said.pop() || `the model refuses to ${doing}`);
  }

  /** Memory for so many references and values, which stays. */
  hold(count) {
    if (count > this.room) {
      if (this.room) { this.own.free(this.keys); this.own.free(this.values); }
      [this.keys, this.values, this.room] = [this.own.malloc(4 * count), this.own.malloc(8 * count), count];
    }
  }

  reference(name) {
    const found = this.references[name];
    if (!found) throw new Error(`the model has no ${name}`);
    return found;
  }

  set(values) {
    for (const [name, value] of Object.entries(values)) {
      const [reference, kind] = this.reference(name);
      this.hold(1);
      new Uint32Array(this.own.memory.buffer, this.keys, 1)[0] = reference;
      if (kind === "Real") new Float64Array(this.own.memory.buffer, this.values, 1)[0] = value;
      else new Int32Array(this.own.memory.buffer, this.values, 1)[0] = value;
      this.demand(this.own[`fmi2Set${kind}`](this.instance, this.keys, 1, this.values), `take ${name}`);
    }
  }

  /** A function that reads Real variables of these names at once, or of these references, as a view that the next
   *  reading overwrites. */
  reader(names) {
    const count = names.length;
    const keys = names.map((one) => (typeof one === "number" ? one : this.reference(one)[0]));
    const at = this.own.malloc(4 * count), values = this.own.malloc(8 * count);
    new Uint32Array(this.own.memory.buffer, at, count).set(keys);
    return () => {
      this.demand(this.own.fmi2GetReal(this.instance, at, count, values), "tell its outputs");
      return new Float64Array(this.own.memory.buffer, values, count);
    };
  }

  /** One variable of any kind. */
  get(name) {
    const [reference, kind] = this.reference(name);
    this.hold(1);
    new Uint32Array(this.own.memory.buffer, this.keys, 1)[0] = reference;
    this.demand(this.own[`fmi2Get${kind}`](this.instance, this.keys, 1, this.values), `tell ${name}`);
    const Kind = kind === "Real" ? Float64Array : Int32Array;
    return new Kind(this.own.memory.buffer, this.values, 1)[0];
  }

  /** To the communication point at `start`, with these values in place of the scene's. */
  begin(values, start) {
    this.set(values);
    this.demand(this.own.fmi2SetupExperiment(this.instance, 0, 0, start, 0, 0), "be set up");
    this.demand(this.own.fmi2EnterInitializationMode(this.instance), "be initialised");
    this.demand(this.own.fmi2ExitInitializationMode(this.instance), "be initialised");
  }

  /** Whether the step was made; false where the model came to its own end, which `said` tells. */
  step(time, size) {
    return this.demand(this.own.fmi2DoStep(this.instance, time, size, 1), "take a step");
  }

  /** Keep the state, in the place of the one that was kept before. */
  save() {
    if (!this.kept) {
      this.kept = this.own.malloc(4);
      new Uint32Array(this.own.memory.buffer, this.kept, 1)[0] = 0;
    }
    this.demand(this.own.fmi2GetFMUstate(this.instance, this.kept), "save its state");
  }

  /** Back to the state that was kept. */
  restore() {
    const [state] = new Uint32Array(this.own.memory.buffer, this.kept, 1);
    this.demand(this.own.fmi2SetFMUstate(this.instance, state), "go back to a state");
  }

  /** Back to the scene's values, in the same memory. */
  reset() {
    this.said.length = 0;
    this.demand(this.own.fmi2Reset(this.instance), "be reset");
  }
}
