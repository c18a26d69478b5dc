using System;
using System.IO;
using Pacinian.Wire;

/// <summary>
/// Reads the lines of Vectors. Decodes and encodes each valid message again and again into the same objects, which must
/// allocate nothing. Rejecting a message must allocate little more than its length.
/// </summary>
internal static class VectorsGarbage
{
    private const int Times = 300;

    private static int Main(string[] arguments)
    {
        string[] lines = File.ReadAllLines(arguments[0]);
        int wrong = 0;
        Refused("control", new byte[0]);
        foreach (string line in lines)
        {
            string[] parts = line.Split('\t');
            byte[] data = VectorsDecoder.Bytes(parts[1]);
            bool valid = parts[2] == "valid";
            long bytes = valid ? Allocated(parts[0], data) : Refused(parts[0], data);
            if (bytes > (valid ? 0 : 20000 + 20 * data.Length))
            {
                wrong++;
                Console.WriteLine(bytes + " bytes: " + line);
            }
        }
        Console.WriteLine(lines.Length + " messages, " + wrong + " with garbage");
        return wrong == 0 && Allocates() ? 0 : 1;
    }

    /// <summary>Returns the allocations for rejecting a message once, including all that this needs.</summary>
    private static long Refused(string socket, byte[] data)
    {
        long before = GC.GetAllocatedBytesForCurrentThread();
        new VectorsDecoder().Read(socket, data);
        return GC.GetAllocatedBytesForCurrentThread() - before;
    }

    private static long Allocated(string socket, byte[] data)
    {
        VectorsDecoder decoder = new VectorsDecoder();
        Writer writer = new Writer();
        long before = 0;
        for (int i = 0; i < Times + 10; i++)
        {
            before = i == 10 ? GC.GetAllocatedBytesForCurrentThread() : before;
            IMessage message = decoder.Read(socket, data);
            writer.Clear();
            message.Write(writer);
        }
        return GC.GetAllocatedBytesForCurrentThread() - before;
    }

    /// <summary>Returns whether the runtime measures allocations.</summary>
    private static bool Allocates()
    {
        long before = GC.GetAllocatedBytesForCurrentThread();
        int length = 0;
        for (int i = 0; i < Times; i++)
        {
            length += new byte[100].Length;
        }
        return GC.GetAllocatedBytesForCurrentThread() - before >= length;
    }
}
