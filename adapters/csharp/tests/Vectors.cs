using System;
using System.IO;

/// <summary>
/// Reads lines with tabs between: socket, bytes in hexadecimal, "valid" or "refused", and the meant bytes or the path
/// of the error. Results must equal Python's. Writes differences; returns 1 if there are any.
/// </summary>
internal static class Vectors
{
    private static int Main(string[] arguments)
    {
        string[] lines = File.ReadAllLines(arguments[0]);
        VectorsDecoder old = new VectorsDecoder();
        int wrong = 0;
        foreach (string line in lines)
        {
            string[] parts = line.Split('\t');
            byte[] data = VectorsDecoder.Bytes(parts[1]);
            string expected = parts[2] + " " + parts[3];
            string fresh = new VectorsDecoder().Decode(parts[0], data), again = old.Decode(parts[0], data);
            if (fresh != expected || again != expected)
            {
                wrong++;
                Console.WriteLine(line + "\n    fresh: " + fresh + "\n    again: " + again);
            }
        }
        Console.WriteLine(lines.Length + " messages, " + wrong + " differ");
        return wrong == 0 ? 0 : 1;
    }
}
