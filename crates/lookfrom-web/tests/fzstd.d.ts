// As far as the page needs it: types are checked without the packages that make the page.

declare module "fzstd" {
    /** The bytes of data that were packed by Zstandard. */
    export function decompress(data: Uint8Array): Uint8Array<ArrayBuffer>;
}
