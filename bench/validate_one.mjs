// node validate_one.mjs PACKAGE FILE.glb: the errors and warnings of the Khronos validator; exit 1
// where there is an error.
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const [, , packageFolder, file] = process.argv;
const validator = createRequire(import.meta.url)(packageFolder);
const report = await validator.validateBytes(new Uint8Array(readFileSync(file)), { maxIssues: 0 });
const { numErrors, numWarnings, messages } = report.issues;
const kinds = [...new Set(messages.filter((m) => m.severity < 2).map((m) => m.code))];
console.log(`validator ${numErrors} errors, ${numWarnings} warnings ${kinds.join(' ')} ${file}`);
process.exit(numErrors > 0 ? 1 : 0);
